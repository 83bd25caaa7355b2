# KDL: what the dynamics are compared with, here and in peers_benchmark.
find_package(orocos_kdl REQUIRED)
find_package(kdl_parser REQUIRED)
target_link_libraries(dynamics_tests knee_simbody ${kdl_parser_LIBRARIES} ${orocos_kdl_LIBRARIES})
