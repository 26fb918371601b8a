# CMake reads this file because the environment variable CMAKE_TOOLCHAIN_FILE names it. So a plain
# `colcon build` or `cmake` of any package works with the ROS 2 wheels from PyPI.
set(CMAKE_PROJECT_INCLUDE "${CMAKE_CURRENT_LIST_DIR}/ros_wheels_fix.cmake")
