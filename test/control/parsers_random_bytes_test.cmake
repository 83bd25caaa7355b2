target_link_libraries(control_parsers_random_bytes_test knee_simulation)  # its simulation file is read too
