// Sums by pixel over the samples of a pass, in images by key, the same bits for every number of
// threads: a pixel's camera paths belong to one chunk, what light paths add is kept by chunk and
// added in order.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "renderer/paths/sample.h"

namespace misbench {

// T: of what is summed.
template <class T>
class PixelSums {
 public:
    PixelSums(std::size_t n_pixels, std::size_t n_channels)
        : n_pixels_(n_pixels), n_channels_(n_channels) {}

    // As SampleObserver's.
    void start_phase(std::size_t n_chunks) {
        chunks_.clear();
        chunks_.resize(n_chunks);
    }
    // One value a channel.
    void add(const Sample& sample, std::size_t chunk, int key, std::size_t pixel,
             std::span<const T> values) {
        Chunk& own = chunks_[chunk];
        T* sums = image_of(key, own) + n_channels_ * pixel;
        if (sample.technique.kind == TechniqueKind::Light) {
            own.places.push_back(sums);
            own.values.insert(own.values.end(), values.begin(), values.end());
        } else {
            add(sums, values.data());
        }
    }
    void finish_phase() {
        for (const Chunk& chunk : chunks_) {
            const T* values = chunk.values.data();
            for (T* sums : chunk.places) {
                add(sums, values);
                values += n_channels_;
            }
        }
        chunks_.clear();
    }

    // Pixel by pixel the channels' sums, by key; only those that had a sample.
    const std::map<int, std::vector<T>>& images() const { return images_; }
    void clear() { images_.clear(); }

 private:
    struct Chunk {
        std::unordered_map<int, T*> known;  // by key, so that each is locked for but once
        std::vector<T*> places;             // of light paths' samples
        std::vector<T> values;
    };

    T* image_of(int key, Chunk& chunk) {
        T*& known = chunk.known[key];
        if (known != nullptr) return known;
        const std::lock_guard lock(mutex_);
        std::vector<T>& image = images_[key];
        image.resize(n_channels_ * n_pixels_);
        known = image.data();
        return known;
    }
    void add(T* sums, const T* values) const {
        for (std::size_t c = 0; c < n_channels_; ++c) sums[c] += values[c];
    }

    std::size_t n_pixels_;
    std::size_t n_channels_;
    std::mutex mutex_;  // of images_, not of what is in one
    std::map<int, std::vector<T>> images_;
    std::vector<Chunk> chunks_;  // of the phase
};

}  // namespace misbench
