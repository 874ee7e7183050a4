// An interpreter that has freshet._freshet built in; all else is python3's.

#include <Python.h>

extern "C" PyObject* PyInit__freshet();

int main(int argc, char** argv) {
  PyImport_AppendInittab("freshet._freshet", PyInit__freshet);
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  PyStatus status = PyConfig_SetBytesArgv(&config, argc, argv);
  if (!PyStatus_Exception(status)) status = Py_InitializeFromConfig(&config);
  PyConfig_Clear(&config);
  if (PyStatus_Exception(status)) Py_ExitStatusException(status);
  // Modules of a package are looked for in its folder alone.
  PyRun_SimpleString(
      "import sys, importlib.machinery as machinery\n"
      "class Built:\n"
      "    @staticmethod\n"
      "    def find_spec(name, path=None, target=None):\n"
      "        if name == 'freshet._freshet':\n"
      "            return machinery.ModuleSpec(name, machinery.BuiltinImporter, origin='built-in')\n"
      "sys.meta_path.insert(0, Built)\n");
  return Py_RunMain();
}
