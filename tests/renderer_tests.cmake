misbench_test(heuristics_test unit misbench_renderer)
misbench_test(optimal_weights_test unit misbench_renderer)
misbench_test(path_densities_test unit misbench_renderer)
misbench_test(path_weights_test unit misbench_renderer)
misbench_test(light_sampler_test unit misbench_renderer)
misbench_test(photon_map_test unit misbench_renderer)
misbench_test(scene_test unit misbench_renderer)
misbench_test(load_test unit misbench_renderer)
misbench_test(mesh_files_test unit misbench_renderer)
misbench_test(seesharp_test unit misbench_renderer)
misbench_test(mitsuba_look_test unit misbench_renderer)
misbench_test(mitsuba_test unit misbench_renderer ZLIB::ZLIB)
misbench_test(inspect_test unit misbench_renderer)
misbench_test(render_loop_test unit misbench_renderer)
misbench_test(pixel_trace_test unit misbench_renderer)
misbench_test(technique_images_test unit misbench_renderer)
misbench_test(bidirectional_test unit misbench_renderer)
target_sources(bidirectional_test PRIVATE support/allocations.cpp)
misbench_test(image_test unit misbench_image OpenEXR::OpenEXR)
misbench_test(texture_test unit misbench_renderer OpenEXR::OpenEXR)
misbench_test(bsdf_test stat misbench_renderer Boost::boost)
misbench_test(bsdf_sampling_test stat misbench_renderer Boost::boost)
misbench_test(radiance_test stat misbench_renderer Boost::boost)
misbench_test(analytic_test stat misbench_renderer Boost::boost)
misbench_test(light_test stat misbench_renderer Boost::boost)
misbench_test(light_choice_test stat misbench_renderer Boost::boost)
misbench_test(environment_test stat misbench_renderer Boost::boost)
misbench_test(extremes_test stat misbench_extremes Boost::boost)
misbench_test(extreme_optics_test stat misbench_extremes Boost::boost)
misbench_test(extremes_bidirectional_test stat misbench_extremes Boost::boost)
target_compile_definitions(extremes_bidirectional_test PRIVATE
  MISBENCH_EXTREMES="${CMAKE_SOURCE_DIR}/experiments/extremes")
misbench_test(self_intersection_test stat misbench_extremes)
misbench_test(merging_test stat misbench_renderer Boost::boost)
misbench_test(camera_test stat misbench_renderer Boost::boost)

# What a full path's densities are, from its vertices alone.
add_library(misbench_path_oracle STATIC support/path_oracle.cpp)
target_link_libraries(misbench_path_oracle PUBLIC misbench_renderer)
misbench_test(path_densities_on_scenes_test stat misbench_path_oracle)

# Whether methods agree.
add_library(misbench_agreement STATIC support/image_agreement.cpp support/estimators.cpp)
target_link_libraries(misbench_agreement PUBLIC misbench_renderer Boost::boost)
misbench_test(image_agreement_test stat misbench_agreement)
misbench_test(methods_agree_test stat misbench_agreement)
misbench_test(methods_agree_on_scenes_test slow misbench_agreement)

foreach(test bidirectional_test load_test inspect_test render_loop_test
    path_densities_on_scenes_test methods_agree_on_scenes_test)
  target_compile_definitions(${test} PRIVATE MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")
endforeach()

# Embree's two queries pass through the benchmark, which keeps and replays them.
misbench_bench(render_bench misbench_renderer embree)
target_link_options(render_bench PRIVATE -Wl,--wrap=rtcIntersect1 -Wl,--wrap=rtcOccluded1)
target_compile_definitions(render_bench PRIVATE MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")

misbench_bench(paths_bench misbench_renderer)
target_compile_definitions(paths_bench PRIVATE MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")
misbench_bench(light_bench misbench_renderer)
misbench_bench(load_bench misbench_renderer)

# Embree is here for its point queries, to compare with.
misbench_bench(photon_bench misbench_renderer embree)
target_compile_definitions(photon_bench PRIVATE MISBENCH_SCENES="${CMAKE_SOURCE_DIR}/experiments/scenes")

# The readers of foreign files under any input: in small for every build, and as libFuzzer's
# binaries for tests/fuzz/run.sh.
add_library(misbench_fuzz_targets STATIC fuzz/targets.cpp)
target_link_libraries(misbench_fuzz_targets PUBLIC misbench_renderer PRIVATE ZLIB::ZLIB)
misbench_test(fuzz_smoke_test unit misbench_fuzz_targets)
target_compile_definitions(fuzz_smoke_test PRIVATE
  MISBENCH_FUZZ_CORPUS="${CMAKE_CURRENT_SOURCE_DIR}/fuzz/corpus")
if(MISBENCH_FUZZ)
  foreach(target json xml ply obj serialized exr)
    add_executable(fuzz_${target} fuzz/libfuzzer.cpp)
    target_link_libraries(fuzz_${target} PRIVATE misbench_fuzz_targets)
    target_link_options(fuzz_${target} PRIVATE -fsanitize=fuzzer)
    target_compile_definitions(fuzz_${target} PRIVATE MISBENCH_FUZZ_TARGET="${target}")
    set_target_properties(fuzz_${target} PROPERTIES
      RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  endforeach()
endif()
