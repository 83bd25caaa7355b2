find_package(benchmark REQUIRED)
target_link_libraries(dynamics_peers_benchmark knee_simbody benchmark::benchmark ${kdl_parser_LIBRARIES} ${orocos_kdl_LIBRARIES})
