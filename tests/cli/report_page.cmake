# Makes pages of a small study and of a rig with the program itself, for the browser test.
execute_process(COMMAND ${NODE} --version OUTPUT_VARIABLE node_version)
if(NOT node_version MATCHES "^v[2-9][0-9]")
  message("report page: skipped: its browser driver needs Node.js 20, this is ${node_version}")
  return()
endif()
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
file(WRITE ${FOLDER}/small.toml
     "[study]\ntrials = 20\nprotocol = \"near_path\"\n[map]\nspacing_m = 2\n"
     "[sweep]\n\"sources.calibration\" = [0.1, 10]\n")
execute_process(COMMAND ${VERNIER} study ${FOLDER}/small.toml -o ${FOLDER}/study -q
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${VERNIER} report ${FOLDER}/study nominal --no-proof
                        -o ${FOLDER}/report.html
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(WRITE ${FOLDER}/grid.toml
     "[study]\ntrials = 12\nprotocol = \"near_path\"\n[map]\nspacing_m = 4\n[sweep]\n"
     "\"sources.calibration\" = [0.1, 10]\n\"localiser.method\" = [\"lines\", \"pgh\"]\n")
execute_process(COMMAND ${VERNIER} study ${FOLDER}/grid.toml -o ${FOLDER}/grid -q
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${VERNIER} report ${FOLDER}/study ${FOLDER}/grid --no-proof
                        -o ${FOLDER}/several.html
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(WRITE ${FOLDER}/calibration.toml
     "[study]\ntrials = 36\n[system]\nname = \"calibration\"\n[calibration]\n"
     "pixel_sigma_px = 0.2\n[sweep]\n\"calibration.views\" = [5, 10]\n")
execute_process(COMMAND ${VERNIER} study ${FOLDER}/calibration.toml -o ${FOLDER}/calibrations -q
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${VERNIER} report ${FOLDER}/calibrations --no-proof
                        -o ${FOLDER}/calibrations.html
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${VERNIER} report ${FOLDER}/study ${FOLDER}/calibrations --no-proof
                        -o ${FOLDER}/systems.html
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${VERNIER} report nominal -o ${FOLDER}/rig.html
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${NODE} ${SOURCE}/page_test.mjs ${FOLDER}/report.html ${FOLDER}/rig.html ${FOLDER}/several.html
                        ${FOLDER}/calibrations.html ${FOLDER}/systems.html
                RESULT_VARIABLE status)
if(status EQUAL 77)
  message("report page: skipped: no playwright-core (npm ci in tests/cli) or no Chromium")
elseif(NOT status EQUAL 0)
  message(FATAL_ERROR "the page's test failed")
endif()
