# campaign_controller: the product's controller with components that misbehave on order, for scripts/fault_campaign only. Not part of
# "all", not installed. The linker puts test/campaign's component factory in place of the product's.
set(factory _ZN10knee_robot7control14componentTypesB5cxx11ERKNS_9mechanism5RobotERKNS0_12HardwareFileERNS_8hardware7AxisBusERKSt5arrayIdLm4EE)
add_executable(campaign_controller EXCLUDE_FROM_ALL src/nodes/controller_main.cpp test/campaign/campaign_controller.cpp)
target_include_directories(campaign_controller PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src/nodes)
target_link_libraries(campaign_controller PRIVATE knee_nodes ${CMAKE_DL_LIBS})
target_compile_definitions(campaign_controller PRIVATE KNEE_FACTORY="${factory}")
set_source_files_properties(src/control/component_types.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # --wrap works between objects only
target_link_options(campaign_controller PRIVATE -Wl,--wrap=${factory} -rdynamic)

# false_trips: the stepped controller on healthy and on blind robots, for scripts/false_trips only.
add_executable(false_trips EXCLUDE_FROM_ALL test/campaign/false_trips.cpp)
target_include_directories(false_trips PRIVATE ${CMAKE_SOURCE_DIR})
target_compile_definitions(false_trips PRIVATE KNEE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
target_link_libraries(false_trips PRIVATE knee_control knee_simulation CLI11::CLI11)

# chain_plant: an open chain in Simbody, for scripts/injection_campaign --chain only. Not part of a build; not installed.
if(TARGET knee_simbody)
  add_executable(chain_plant EXCLUDE_FROM_ALL test/campaign/chain_plant.cpp)
  target_link_libraries(chain_plant PRIVATE knee_mechanism ${Simbody_LIBRARIES})
  target_compile_options(chain_plant PRIVATE "SHELL:-isystem ${Simbody_INCLUDE_DIR}" -UNDEBUG)
  set_target_properties(chain_plant PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/campaign)
endif()
