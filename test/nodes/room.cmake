target_include_directories(nodes_tests SYSTEM PRIVATE ${rosbag_storage_INCLUDE_DIRS})
target_link_libraries(nodes_tests knee_bag_import)
knee_runs_programs(nodes baseline_of_programs_test identify trace)
knee_runs_programs(nodes tune_pid_test tune_pid check_reference simulate)
knee_runs_programs(nodes identify_program_test identify trace plan_excitation)
knee_runs_programs(nodes programs_test plan_exercise check_reference plan_excitation simulate compare trace predict import_recording
  virtual_plant simulated_camera)
knee_runs_programs(nodes node_help_test controller monitor monitor_markers)
# What only scripts build must not rot either.
add_dependencies(nodes_tests campaign_controller false_trips)
