# All sources of a target in one compilation: OpenVDB's headers, and the code that they put into
# every object, are paid once a target instead of once a file. Single files are for those who edit
# them.
option(VDB_MADF_UNITY "Compile each target as one file" ON)

# Flags of our own targets, never of those that link us.
function(vdb_madf_compiler_options target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${VDB_MADF_UNITY} UNITY_BUILD_BATCH_SIZE 0)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wno-psabi -ffp-contract=off)
  # GCC looks for what it may forget from 2 GB on: a tenth of the time for half a GB more.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${target} PRIVATE --param=ggc-min-heapsize=2000000)
  endif()
  if(VDB_MADF_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# The same with AddressSanitizer and UndefinedBehaviorSanitizer. (No -Werror: GCC 12 warns falsely
# of uninitialized values when it instruments.) Left out is what AddressSanitizer sees as the bad
# access itself: these checks would double the time to compile.
function(vdb_madf_sanitize target)
  target_compile_options(${target} PRIVATE -Og -Wno-error -fsanitize=address,undefined
    -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr -fno-sanitize-recover=all
    -fno-omit-frame-pointer -g1)
  target_link_options(${target} PUBLIC -fsanitize=address,undefined)
endfunction()

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND PROJECT_IS_TOP_LEVEL)
  message(STATUS
    "No CMAKE_BUILD_TYPE given: the library will be slow. Use -DCMAKE_BUILD_TYPE=Release.")
endif()
