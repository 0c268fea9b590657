# The CMake targets that the wheels of ROS 2 bring name folders of the machine that built them: Python's and NumPy's
# headers below /opt/python, libraries in /usr/lib64. When a project's CMakeLists.txt has been read, put this machine's
# in their place, in the targets alone: no installed file is changed.

function(_course_kit_correct_targets)
  get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(headers ${target} INTERFACE_INCLUDE_DIRECTORIES)
    if(headers MATCHES "/opt/python/")
      list(TRANSFORM headers REPLACE "^/opt/python/.*/numpy/.*$" "${Python3_NumPy_INCLUDE_DIRS}")
      list(TRANSFORM headers REPLACE "^/opt/python/.*/include/python.*$" "${Python3_INCLUDE_DIRS}")
      list(REMOVE_ITEM headers "") # a project that did not look for Python needs none of its headers
      set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${headers}")
    endif()
    get_target_property(libraries ${target} INTERFACE_LINK_LIBRARIES)
    if(libraries MATCHES "/usr/lib64/")
      list(FILTER libraries EXCLUDE REGEX "^/usr/lib64/")
      set_target_properties(${target} PROPERTIES INTERFACE_LINK_LIBRARIES "${libraries}")
    endif()
  endforeach()
endfunction()

# The libraries of interfaces use the C++ library of ROS 2's own; see course_kit/setup/environment/compiler.py.
function(_course_kit_leave_out_own_runtime)
  get_property(targets DIRECTORY PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    if(target MATCHES "__rosidl_" AND type MATCHES "_LIBRARY$" AND NOT type MATCHES "^(INTERFACE|STATIC)")
      target_link_options(${target} PRIVATE -nostdlib++)
    endif()
  endforeach()
endfunction()

if(CMAKE_CURRENT_SOURCE_DIR STREQUAL CMAKE_SOURCE_DIR)
  list(PREPEND CMAKE_MODULE_PATH "${CMAKE_CURRENT_LIST_DIR}/modules")
  if(COURSE_KIT_COMPILER_IS_WHEEL)
    cmake_language(DEFER CALL _course_kit_leave_out_own_runtime)
  endif()
  cmake_language(DEFER CALL _course_kit_correct_targets)
endif()
