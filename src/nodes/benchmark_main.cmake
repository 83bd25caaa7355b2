find_package(benchmark REQUIRED)
target_link_libraries(benchmark_program PRIVATE benchmark::benchmark)
