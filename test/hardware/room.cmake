target_link_libraries(hardware_tests knee_simulation)  # the models of cards and drives
