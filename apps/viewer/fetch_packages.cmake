# Installs the packages that FOLDER's lock file names and writes STAMP. Without them, as where there is no network, the
# program is built without its page, and the next build tries again.
execute_process(COMMAND "${NPM}" ci --ignore-scripts --no-audit --no-fund --loglevel=error --fetch-retries=1
  WORKING_DIRECTORY "${FOLDER}" RESULT_VARIABLE result OUTPUT_QUIET)
if(result EQUAL 0)
  file(TOUCH "${STAMP}")
else()
  file(REMOVE_RECURSE "${FOLDER}/node_modules")
  message(WARNING "npm could not fetch the packages of the page of saccade view (see above): the program is built "
    "without the page. With -DSACCADE_WITH_VIEW_PAGE=OFF it is not tried.")
endif()
