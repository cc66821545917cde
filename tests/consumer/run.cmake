# Installs the built library into a scratch prefix, then configures, builds and runs a consumer
# against that tree alone. Variables: BUILD_DIR, SOURCE_DIR, WORK_DIR, GENERATOR, BUILD_TYPE;
# PROGRAMS, if it makes others than one called consumer.
include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)

file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
step(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
step(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
step(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
if(NOT PROGRAMS)
  set(PROGRAMS consumer)
endif()
foreach(program IN LISTS PROGRAMS)
  step(${WORK_DIR}/build/${program})
endforeach()
