# test/ROOM/NAME_test.cpp: one gtest program a file, linked with its room. test/nodes/*.test: rostests.
# "make tests", then ctest -j; every test writes JUnit XML that scripts/test counts.
file(GLOB room_tests RELATIVE ${CMAKE_SOURCE_DIR}/test CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/test/*/*_test.cpp)
foreach(test_file ${room_tests})
  get_filename_component(room ${test_file} DIRECTORY)
  get_filename_component(name ${test_file} NAME_WE)
  catkin_add_gtest(${room}_${name} test/${test_file} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  if(TARGET ${room}_${name})
    target_link_libraries(${room}_${name} knee_${room} ${GTEST_MAIN_LIBRARIES})
    if(room MATCHES "^(hardware|control)$")
      target_link_libraries(${room}_${name} knee_simulation)  # the models of cards and drives
    endif()
    target_include_directories(${room}_${name} PRIVATE ${CMAKE_SOURCE_DIR})
    target_compile_definitions(${room}_${name} PRIVATE KNEE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
    if(EXISTS ${CMAKE_SOURCE_DIR}/test/${room}/${name}.cmake)
      include(${CMAKE_SOURCE_DIR}/test/${room}/${name}.cmake)  # extra libraries of this one test (Simbody, ...)
    endif()
  endif()
endforeach()

# test/operator/NAME_test.py: unit tests of the operator's page; they need neither a master nor a robot.
file(GLOB page_tests RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/test/operator/*_test.py)
foreach(page_test ${page_tests})
  get_filename_component(name ${page_test} NAME_WE)
  add_test(NAME operator_${name} COMMAND ${CMAKE_BINARY_DIR}/catkin_generated/env_cached.sh ${PYTHON_EXECUTABLE} ${CMAKE_SOURCE_DIR}/${page_test}
    --gtest_output=xml:${CMAKE_BINARY_DIR}/test_results/knee_robot/operator-${name}.xml)
endforeach()
set_tests_properties(operator_browser_test PROPERTIES RUN_SERIAL ON)  # a browser beside compute-bound tests takes a minute to start

# Each rostest has a roscore and a simulated robot of its own. They run one at a time: a robot that shares the machine with
# compute-bound tests would measure those.
file(GLOB ros_tests RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/test/nodes/*.test)
foreach(ros_test ${ros_tests})
  get_filename_component(name ${ros_test} NAME_WE)
  add_rostest(${ros_test})
  set_tests_properties(_ctest_knee_robot_rostest_test_nodes_${name}.test PROPERTIES RUN_SERIAL ON)
endforeach()

# test/ROOM/NAME_benchmark.cpp: other engines beside ours, on request only (scripts/benchmark_peers).
file(GLOB room_benchmarks RELATIVE ${CMAKE_SOURCE_DIR}/test CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/test/*/*_benchmark.cpp)
foreach(benchmark_file ${room_benchmarks})
  get_filename_component(room ${benchmark_file} DIRECTORY)
  get_filename_component(name ${benchmark_file} NAME_WE)
  add_executable(${room}_${name} EXCLUDE_FROM_ALL test/${benchmark_file})
  target_link_libraries(${room}_${name} knee_${room})
  target_include_directories(${room}_${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_compile_definitions(${room}_${name} PRIVATE KNEE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  include(${CMAKE_SOURCE_DIR}/test/${room}/${name}.cmake OPTIONAL)
endforeach()
