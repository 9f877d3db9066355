# Builds the page in FOLDER with Vite and writes it to OUTPUT, a C++ source; without packages, copies ABSENT there.
if(NOT EXISTS "${FOLDER}/node_modules")
  configure_file("${ABSENT}" "${OUTPUT}" COPYONLY)
  return()
endif()
execute_process(COMMAND "${NPM}" --prefix "${FOLDER}" run --silent build COMMAND_ERROR_IS_FATAL ANY)
set(PAGE "${FOLDER}/dist")
include("${CMAKE_CURRENT_LIST_DIR}/embed_page.cmake")
