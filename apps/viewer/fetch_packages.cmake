# Installs the packages that FOLDER's lock file names.
execute_process(COMMAND "${NPM}" ci --ignore-scripts --no-audit --no-fund --loglevel=error
  WORKING_DIRECTORY "${FOLDER}" RESULT_VARIABLE result OUTPUT_QUIET)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "npm could not fetch the packages of the page of saccade view (see above). "
    "With -DSACCADE_WITH_VIEW_PAGE=OFF the program is built without the page.")
endif()
