misbench_test(lease_table_test sim misbench_queue)
misbench_test(session_test sim misbench_session misbench_results)
misbench_test(task_queue_test sim misbench_queue)
misbench_test(codec_test unit misbench_proto misbench_proto_generated)
misbench_test(fleet_test e2e misbench_proto misbench_results misbench_renderer)
target_compile_definitions(fleet_test PRIVATE
  MISBENCH_COORDINATOR="$<TARGET_FILE:misbench-coordinator>"
  MISBENCH_WORKER="$<TARGET_FILE:misbench-worker>"
  MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")
add_dependencies(fleet_test misbench-coordinator misbench-worker)

misbench_bench(queue_bench misbench_queue)
