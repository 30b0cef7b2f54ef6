# Installs BUILD into a fresh folder and uses what is there as a program elsewhere does:
#   cmake -DBUILD=... -DSOURCE=... -DWORK=... -DCOMPILER=g++ -DGPL=ON -DSHARED=OFF -P run.cmake
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})

# ---- the public headers, and nothing else
file(GLOB_RECURSE headers RELATIVE ${prefix}/include ${prefix}/include/*)
list(LENGTH headers count)
if(count GREATER 15)
  message(FATAL_ERROR "${count} headers are installed, expected at most 15: ${headers}")
endif()
foreach(header ${headers})
  if(NOT header MATCHES "^isowave/[a-z]+\\.h$")
    message(FATAL_ERROR "${header} is installed; only include/isowave/*.h are public")
  endif()
endforeach()

# ---- examples/ by find_package
run(${CMAKE_COMMAND} -S ${SOURCE}/examples -B ${WORK}/build -DCMAKE_PREFIX_PATH=${prefix}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)

# The library gives the very meshes that the command gives.
set(part ${SOURCE}/tests/data/meshes/gearwheel.bin.stl)
set(tool ${prefix}/bin/isowave)
file(MAKE_DIRECTORY ${WORK}/library/part)
run(${WORK}/build/ladder ${part} ${WORK}/library/part)
run(${tool} lod ${part} --voxels 64 --quiet -o ${WORK}/command/part)
file(GLOB meshes RELATIVE ${WORK}/library/part ${WORK}/library/part/*.ply)
file(GLOB expected RELATIVE ${WORK}/command/part ${WORK}/command/part/*.ply)
if(NOT expected OR NOT meshes STREQUAL expected)
  message(FATAL_ERROR "examples/ladder wrote '${meshes}', isowave lod '${expected}'")
endif()
foreach(mesh ${meshes})
  run(${CMAKE_COMMAND} -E compare_files ${WORK}/library/part/${mesh} ${WORK}/command/part/${mesh})
endforeach()

run(${WORK}/build/own_array)
run(${tool} analyse ${part} --voxels 64 --quiet -o ${WORK}/part.pyramid.vdb)
run(${WORK}/build/pyramid_table ${WORK}/part.pyramid.vdb)

# ---- one component, where the packages of the others cannot be found
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install/curves_only -B ${WORK}/curves_only -DCMAKE_PREFIX_PATH=${prefix}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release -DCMAKE_DISABLE_FIND_PACKAGE_OpenVDB=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_GDCM=ON -DCMAKE_DISABLE_FIND_PACKAGE_CGAL=ON)
run(${CMAKE_COMMAND} --build ${WORK}/curves_only)
run(${WORK}/curves_only/curves_only ${SOURCE}/tests/data/curves2d/keyring.png)

# ---- nothing in the package points back into the build or source folder
file(GLOB_RECURSE package ${prefix}/lib/*.cmake)
foreach(file ${package})
  file(READ ${file} text)
  foreach(folder ${BUILD} ${SOURCE})
    string(FIND "${text}" "${folder}/" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} mentions ${folder}")
    endif()
  endforeach()
endforeach()
