misbench_test(base_test unit misbench_base)
