# rosbag's C++ storage: only the program that imports bags, and its test, link it; the headers are for nodes/bag_import.cpp.
find_package(rosbag_storage REQUIRED)
set_source_files_properties(src/nodes/bag_import.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # other programs do not link rosbag
target_include_directories(knee_nodes SYSTEM PRIVATE ${rosbag_storage_INCLUDE_DIRS})
