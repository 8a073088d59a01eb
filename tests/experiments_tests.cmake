misbench_test(experiment_file_test unit misbench_experiment_file)
misbench_test(profile_test unit misbench_experiment_file misbench_results)
misbench_test(resolve_test unit misbench_experiments)
target_compile_definitions(resolve_test PRIVATE
  MISBENCH_EXPERIMENTS="${CMAKE_SOURCE_DIR}/experiments")
misbench_test(claims_formats_test unit misbench_report)
misbench_test(figure_file_test unit misbench_figure)
misbench_test(figure_experiments_test unit misbench_figure misbench_experiments)
target_compile_definitions(figure_experiments_test PRIVATE
  MISBENCH_EXPERIMENTS="${CMAKE_SOURCE_DIR}/experiments")
misbench_test(figure_layout_test unit misbench_figure)
misbench_test(figure_test unit misbench_figure pugixml::pugixml)
misbench_test(report_test unit misbench_report ZLIB::ZLIB)
misbench_test(table_test unit misbench_report)
misbench_test(seed_rounds_test unit misbench_report)
misbench_test(tradeoff_test unit misbench_report)
misbench_test(progress_test unit misbench_cli)
misbench_test(path_story_test unit misbench_cli)
misbench_test(image_list_test unit misbench_cli)
misbench_test(run_test e2e misbench_results)
misbench_test(adaptive_test e2e misbench_results)
misbench_test(reference_test e2e misbench_results)
misbench_test(claims_test e2e misbench_results)
misbench_test(lab_test unit misbench_lab)
misbench_test(lab_sampling_test stat misbench_lab Boost::boost)
misbench_test(lab_cli_test e2e misbench_base)
misbench_test(compare_test e2e misbench_image)

# One test for ctest each, because their cases share an experiment that takes seconds to run.
foreach(test cli_test figure_cli_test replay_test stores_test verdict_test)
  add_executable(${test} e2e/${test}.cpp)
  target_link_libraries(${test}
    PRIVATE misbench_flags GTest::gmock GTest::gtest_main misbench_results)
  set_target_properties(${test} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
endforeach()
target_link_libraries(replay_test PRIVATE OpenEXR::OpenEXR)
target_link_libraries(figure_cli_test PRIVATE PNG::PNG pugixml::pugixml)
add_test(NAME CliTest COMMAND cli_test)
add_test(NAME FigureCliTest COMMAND figure_cli_test)
add_test(NAME ReplayTest COMMAND replay_test)
add_test(NAME StoresTest COMMAND stores_test)
add_test(NAME VerdictTest COMMAND verdict_test)
set_tests_properties(CliTest FigureCliTest ReplayTest StoresTest VerdictTest
  PROPERTIES LABELS e2e TIMEOUT 300)

foreach(test adaptive_test claims_test cli_test figure_cli_test reference_test replay_test run_test
        stores_test verdict_test)
  target_compile_definitions(${test} PRIVATE
    MISBENCH_PROGRAM="$<TARGET_FILE:misbench>"
    MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")
  add_dependencies(${test} misbench misbench-coordinator misbench-worker)
endforeach()
target_compile_definitions(lab_cli_test PRIVATE
  MISBENCH_PROGRAM="$<TARGET_FILE:misbench>"
  MISBENCH_EXPERIMENTS="${CMAKE_SOURCE_DIR}/experiments")
add_dependencies(lab_cli_test misbench)
target_compile_definitions(compare_test PRIVATE MISBENCH_PROGRAM="$<TARGET_FILE:misbench>")
add_dependencies(compare_test misbench)
