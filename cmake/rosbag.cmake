# rosbag's C++ storage: only the program that imports bags, and its test, link it; the headers are for nodes/bag_import.cpp.
find_package(rosbag_storage REQUIRED)
target_include_directories(knee_nodes SYSTEM PRIVATE ${rosbag_storage_INCLUDE_DIRS})
