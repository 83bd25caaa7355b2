find_package(Simbody REQUIRED)
find_package(benchmark REQUIRED)
target_include_directories(dynamics_peers_benchmark SYSTEM PRIVATE ${Simbody_INCLUDE_DIR})
target_link_libraries(dynamics_peers_benchmark ${Simbody_LIBRARIES} benchmark::benchmark)
# Debian's Simbody is built with assertions on, and its inline classes have another layout without them.
target_compile_options(dynamics_peers_benchmark PRIVATE -UNDEBUG)
