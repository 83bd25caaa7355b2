# One gtest program a room, ROOM_tests of test/ROOM/*_test.cpp; one ctest entry a source file, which the program is told by --file.
# Libraries that a room's tests need beyond their room: test/ROOM/room.cmake. A test with NAME_test.cmake beside it is a program of its own.
# test/nodes/*.test: rostests. "ninja tests", then ctest -j; every entry writes JUnit XML that scripts/test counts.

add_library(knee_test_main STATIC test/main.cpp test/allocation_guard.cpp)
target_include_directories(knee_test_main PUBLIC ${PROJECT_SOURCE_DIR} PRIVATE ${GTEST_INCLUDE_DIRS})
# main changes to the source folder. The tests' own flags hold no absolute path: the compiler cache serves every checkout.
set_source_files_properties(test/main.cpp PROPERTIES COMPILE_DEFINITIONS KNEE_CHECKOUT="${PROJECT_SOURCE_DIR}")
set_target_properties(knee_test_main PROPERTIES CXX_COMPILER_LAUNCHER "")  # ccache would give another checkout the object of this one
target_compile_definitions(knee_test_main PUBLIC KNEE_SOURCE_DIR=".")
target_link_libraries(knee_test_main PUBLIC knee_robot_options ${GTEST_LIBRARIES})
set_target_properties(knee_test_main PROPERTIES EXCLUDE_FROM_ALL ON)
# The libraries are what is fast; less optimization of the tests themselves saves a quarter of their compilation.
set(knee_test_optimization $<$<CONFIG:Release>:-O1>)
if(KNEE_PRECOMPILED)
  knee_precompiled(test LIBRARIES Eigen3::Eigen ${GTEST_LIBRARIES} HEADERS <gtest/gtest.h> <Eigen/Dense>
    ${PROJECT_SOURCE_DIR}/include/knee_robot/mechanism/decompositions.h)
  target_compile_options(knee_precompiled_test PRIVATE ${knee_test_optimization})
endif()

function(knee_test_program name room)
  catkin_add_executable_with_gtest(${name} ${ARGN} EXCLUDE_FROM_ALL)
  target_link_libraries(${name} knee_${room} knee_test_main)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${KNEE_UNITY} UNITY_BUILD_BATCH_SIZE 18)  # a third of the compiler's work is left
  target_compile_options(${name} PRIVATE ${knee_test_optimization})
  knee_use_precompiled(${name} test)
  add_dependencies(tests ${name})
endfunction()

# The ctest entry of a program, or of one source of it (ARGN: --file=NAME)
function(knee_test_entry entry program)
  get_target_property(folder ${program} RUNTIME_OUTPUT_DIRECTORY)
  catkin_run_tests_target(gtest ${entry} gtest-${entry}.xml DEPENDENCIES ${program} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMAND "${folder}/${program} ${ARGN} --gtest_output=xml:${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME}/gtest-${entry}.xml")
endfunction()

# test/ROOM/NAME.cpp runs these programs as a user does; KNEE_<PROGRAM> is the path.
function(knee_runs_programs room name)
  foreach(program ${ARGN})
    string(TOUPPER ${program} upper)
    add_dependencies(${room}_tests ${program}_program)
    set_property(SOURCE ${PROJECT_SOURCE_DIR}/test/${room}/${name}.cpp APPEND PROPERTY
      COMPILE_DEFINITIONS KNEE_${upper}="$<TARGET_FILE:${program}_program>")
  endforeach()
endfunction()

foreach(room ${knee_rooms} nodes)
  file(GLOB test_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/${room}/*_test.cpp)
  set(together ${test_files})
  foreach(test_file ${test_files})
    get_filename_component(name ${test_file} NAME_WE)
    if(EXISTS ${PROJECT_SOURCE_DIR}/test/${room}/${name}.cmake)
      list(REMOVE_ITEM together ${test_file})
      knee_test_program(${room}_${name} ${room} ${test_file})
      knee_test_entry(${room}_${name} ${room}_${name})
      include(${PROJECT_SOURCE_DIR}/test/${room}/${name}.cmake)
    endif()
  endforeach()
  if(together)
    knee_test_program(${room}_tests ${room} ${together})
    include(${PROJECT_SOURCE_DIR}/test/${room}/room.cmake OPTIONAL)
    foreach(test_file ${together})
      get_filename_component(name ${test_file} NAME_WE)
      knee_test_entry(${room}_${name} ${room}_tests --file=${name})
    endforeach()
  endif()
endforeach()

# test/ROOM/NAME_test.py of what operators see, of reports and of this suite itself: unit tests; they need neither a master nor a robot.
file(GLOB python_tests RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/operator/*_test.py
  ${PROJECT_SOURCE_DIR}/test/report/*_test.py ${PROJECT_SOURCE_DIR}/test/suite/*_test.py)
foreach(python_test ${python_tests})
  get_filename_component(name ${python_test} NAME_WE)
  get_filename_component(room ${python_test} DIRECTORY)
  get_filename_component(room ${room} NAME)
  add_test(NAME ${room}_${name} COMMAND ${PROJECT_BINARY_DIR}/catkin_generated/env_cached.sh ${PYTHON_EXECUTABLE} ${PROJECT_SOURCE_DIR}/${python_test}
    --gtest_output=xml:${PROJECT_BINARY_DIR}/test_results/knee_robot/${room}-${name}.xml)
endforeach()
set_tests_properties(report_browser_test PROPERTIES ENVIRONMENT "KNEE_BUILD=${PROJECT_BINARY_DIR}")

# test/fleet: pytest on the fleet's Python package (scripts/fleet_tests), with the programs of this build.
add_test(NAME fleet COMMAND ${CMAKE_SOURCE_DIR}/scripts/fleet_tests --yield --junitxml=${CMAKE_BINARY_DIR}/test_results/fleet/pytest-fleet.xml)
set_tests_properties(fleet PROPERTIES ENVIRONMENT "KNEE_BUILD=${CMAKE_BINARY_DIR}" TIMEOUT 1200)

# Each rostest has a roscore and a simulated robot of its own. They run after other tests: a robot that shares the machine with
# compute-bound tests would measure those. They wait more than they compute: three on two processors, of which one identifies or draws, and
# beside them the fleet's tests, which at first compute only when nothing else does (a processor is idle for the scheduler, and a robot
# wakes there at once). scripts/test gives ctest three shares a processor and one more; what computes takes three of them, a rostest two,
# the fleet's one. A virtual machine that has less than its processors loses one of them for 0.1 s at a time (18 times a minute were seen):
# every rostest binds its robot, servo cycle and guardian to one processor (cpu:=), so that they stand still together.
get_property(computing_tests DIRECTORY PROPERTY TESTS)
list(REMOVE_ITEM computing_tests operator_browser_test report_browser_test fleet)
set_tests_properties(${computing_tests} PROPERTIES PROCESSORS 3)
file(GLOB ros_tests RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/nodes/*.test)
foreach(ros_test ${ros_tests})
  get_filename_component(name ${ros_test} NAME_WE)
  add_rostest(${ros_test})
  list(APPEND waiting_tests _ctest_knee_robot_rostest_test_nodes_${name}.test)
endforeach()
list(APPEND waiting_tests operator_browser_test report_browser_test)  # a browser beside compute-bound tests takes a minute to start
set_tests_properties(${waiting_tests} PROPERTIES DEPENDS "${computing_tests}" PROCESSORS 2)
set_tests_properties(fleet PROPERTIES DEPENDS "${computing_tests}" COST 200)
set_tests_properties(operator_page_test PROPERTIES COST 60)  # it waits for half a minute: not as the last of those that compute
foreach(name launch_files identification operator_page)
  list(APPEND drawing_tests _ctest_knee_robot_rostest_test_nodes_${name}.test)
endforeach()
set_tests_properties(${drawing_tests} operator_browser_test report_browser_test PROPERTIES RESOURCE_LOCK computing COST 50)
set_tests_properties(_ctest_knee_robot_rostest_test_nodes_laboratory_file.test PROPERTIES COST 100)  # the longest: begins first,
foreach(name play action guiding)
  set_tests_properties(_ctest_knee_robot_rostest_test_nodes_${name}.test PROPERTIES COST 40)  # and these before the short ones
endforeach()

# test/ROOM/NAME_benchmark.cpp: other engines beside ours, on request only (scripts/benchmark_peers).
file(GLOB room_benchmarks RELATIVE ${PROJECT_SOURCE_DIR}/test CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/*/*_benchmark.cpp)
foreach(benchmark_file ${room_benchmarks})
  get_filename_component(room ${benchmark_file} DIRECTORY)
  get_filename_component(name ${benchmark_file} NAME_WE)
  add_executable(${room}_${name} EXCLUDE_FROM_ALL test/${benchmark_file})
  target_link_libraries(${room}_${name} knee_${room})
  target_include_directories(${room}_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(${room}_${name} PRIVATE KNEE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  include(${PROJECT_SOURCE_DIR}/test/${room}/${name}.cmake OPTIONAL)
endforeach()
