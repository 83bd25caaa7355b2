# rosbag's C++ storage: only the program that imports bags, and its test, link it.
find_package(rosbag_storage REQUIRED)
add_library(knee_bag_import STATIC EXCLUDE_FROM_ALL src/nodes/bag_import.cpp)
target_include_directories(knee_bag_import SYSTEM PRIVATE ${rosbag_storage_INCLUDE_DIRS})
target_link_libraries(knee_bag_import PUBLIC knee_nodes ${rosbag_storage_LIBRARIES})
knee_use_precompiled(knee_bag_import program)
