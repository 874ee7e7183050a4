import ast
import inspect
import pathlib
import re
import unittest

import freshet

import benchmark_test  # noqa: F401  what they cover is known once they are imported
import calls_test  # noqa: F401
import search_test  # noqa: F401
import store_test  # noqa: F401
import ways_test  # noqa: F401
from harness import COVERED

MODULES = {"hdf5"}  # that a user imports beside the module
PROTOCOL = {"OwnIndex"}  # of types alone


def members(thing):
    for name in vars(thing):
        if name in ("__len__", "__getitem__", "__next__", "__iter__", "__enter__", "__exit__") or not name.startswith("_"):
            yield name
    if inspect.isclass(thing) and "__init__" in vars(thing) and "__init__(self: " in (thing.__init__.__doc__ or ""):
        yield "__init__"


def public():
    """module.name, and module.Class.name."""
    names = set()
    for name in dir(freshet):
        if name.startswith("_") or name in MODULES:
            continue
        names.add(name)
        if inspect.isclass(getattr(freshet, name)):
            names |= {f"{name}.{member}" for member in members(getattr(freshet, name))}
    return names | {"Error.kind"}


def stubs():
    """What __init__.pyi has: name to its parameters, or None."""
    tree = ast.parse(pathlib.Path(inspect.getfile(freshet) + "i").read_text())
    found = {}

    def parameters(function):
        arguments = function.args
        return [a.arg for a in arguments.args + arguments.kwonlyargs if a.arg != "self"]
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = parameters(node)
        if isinstance(node, ast.ClassDef) and node.name not in PROTOCOL:
            found[node.name] = None
            for member in node.body:
                if isinstance(member, ast.FunctionDef):
                    found[f"{node.name}.{member.name}"] = parameters(member)
                elif isinstance(member, ast.AnnAssign):
                    found[f"{node.name}.{member.target.id}"] = None
    return found


class Names(unittest.TestCase):
    def test_every_public_name_has_a_test(self):
        self.assertEqual(public() - set(COVERED), set())
        self.assertEqual(set(COVERED) - public(), set())

    def test_all_is_what_there_is(self):
        self.assertEqual(set(freshet.__all__), {name for name in public() if "." not in name})

    def test_everything_says_what_it_is(self):
        for name in freshet.__all__:
            self.assertTrue(getattr(freshet, name).__doc__, name)

    def test_the_types_name_the_same_things_and_parameters(self):
        found = stubs()
        without = {name for name in public() if name.endswith("__iter__")}  # of Iterator
        self.assertEqual(public() - without - set(found), set())
        self.assertEqual(set(found) - public(), set())
        for name, parameters in found.items():
            if parameters is None:
                continue
            thing = freshet
            for part in name.split("."):
                thing = getattr(thing, part)
            signature = re.match(r"\w+\((.*)\)", (thing.__doc__ or "").split("\n")[0])
            if not signature or "**kwargs" in signature[1] or "arg0" in signature[1]:
                continue
            own = re.findall(r"(?:^|, )(\w+): ", re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", signature[1])))
            self.assertEqual([one for one in own if one != "self"], parameters, name)
