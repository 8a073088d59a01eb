misbench_test(base_test unit misbench_base)
misbench_test(architecture_test unit misbench_base)
target_compile_definitions(architecture_test PRIVATE MISBENCH_SOURCE="${CMAKE_SOURCE_DIR}")
