# $CMAKE_TOOLCHAIN_FILE of the course's environment, set where ROS 2 comes from wheels.
# CMake would take the newest Python of the machine; the packages are for this environment's.
if(NOT DEFINED Python3_EXECUTABLE)
  get_filename_component(Python3_EXECUTABLE "${CMAKE_CURRENT_LIST_DIR}/../../../bin/python3" ABSOLUTE)
endif()
if(NOT DEFINED CMAKE_PROJECT_INCLUDE)
  set(CMAKE_PROJECT_INCLUDE "${CMAKE_CURRENT_LIST_DIR}/ros_wheels.cmake")
endif()
