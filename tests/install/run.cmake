# Installs BUILD into a fresh folder, builds the consumer against it, runs it:
#   cmake -DBUILD=... -DSOURCE=... -DWORK=... -DCOMPILER=g++ -DMEASURE=ON -P run.cmake
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)

# Headers of isowave::measure are there exactly where its library is.
file(GLOB_RECURSE headers ${WORK}/prefix/include/*/measure*.h)
if((MEASURE AND NOT headers) OR (headers AND NOT MEASURE))
  message(FATAL_ERROR "ISOWAVE_MEASURE is '${MEASURE}' and these headers of it are installed: '${headers}'")
endif()

# Nothing in the package may point back into the build or source folder.
file(GLOB_RECURSE package ${WORK}/prefix/lib/*.cmake)
foreach(file ${package})
  file(READ ${file} text)
  foreach(folder ${BUILD} ${SOURCE})
    string(FIND "${text}" "${folder}/" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} mentions ${folder}")
    endif()
  endforeach()
endforeach()
