misbench_test(heuristics_test unit misbench_renderer)
misbench_test(scene_test unit misbench_renderer)
misbench_test(render_loop_test unit misbench_renderer)
misbench_test(image_test unit misbench_image)
misbench_test(bsdf_test stat misbench_renderer Boost::boost)
misbench_test(radiance_test stat misbench_renderer Boost::boost)
foreach(test scene_test render_loop_test)
  target_compile_definitions(${test} PRIVATE MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")
endforeach()

# Embree's two queries pass through the benchmark, which keeps and replays them.
misbench_bench(render_bench misbench_renderer embree)
target_link_options(render_bench PRIVATE -Wl,--wrap=rtcIntersect1 -Wl,--wrap=rtcOccluded1)
target_compile_definitions(render_bench PRIVATE MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")
