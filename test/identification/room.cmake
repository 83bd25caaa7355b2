target_link_libraries(identification_tests knee_control)  # the Pid that moves the simulated axes
