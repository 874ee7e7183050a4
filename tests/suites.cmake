# A test of ctest for each suite of a program's tests: most tests take less time than the program takes to start. Ran when
# the program was built, with -D PROGRAM=FILE -D TESTS=FILE: writes into TESTS what ctest is to run.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "(^|\n)[^ \n]+\\.[ \n]" suites "${listed}")
set(tests "")
foreach(suite ${suites})
  string(REGEX REPLACE "[. \n]+$" "" suite "${suite}")
  string(STRIP "${suite}" suite)
  string(APPEND tests "add_test([=[${suite}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${suite}.*]=])\n"
                      "set_tests_properties([=[${suite}]=] PROPERTIES SKIP_RETURN_CODE 77)\n")
endforeach()
file(WRITE ${TESTS} "${tests}")
