#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/render/image/video.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/render/picture/scene_renderer.hpp"

namespace taut {

/// Times of the frames of a video [s]: from the start on, whole steps of the coarsest run, as near
/// to `wanted` [s] apart as these allow; two at least.
std::vector<double> frame_times(const Scene&, const std::vector<RecordedRun>&, double wanted,
                                double duration);

/// Draws and encodes a frame for each of these times; `speed` and `crf` as in MediaOptions. Returns
/// "", or the reason why there is no file (VideoWriter::finish).
std::string write_video(const std::filesystem::path& mp4, const SceneRenderer&, const PageLayout&,
                        const std::vector<double>& times, double speed, int crf,
                        const std::function<void(std::size_t done, std::size_t all)>& progress);

/// How a report draws a scene: panels alone (PageLayout::bare) on the dark background; the page
/// writes captions and the colour bar itself, in its own fonts and themes.
struct MediaOptions {
  int width = 960, height = 400;  ///< of all panels together; even
  double duration = 4;            ///< s of the scene's beginning
  double speed = 1;               ///< simulated seconds per second of video
  double fps = 16;  ///< of the video; frames are whole steps: the nearest rate that dt allows
  RenderQuality quality = RenderQuality::video();
  int crf = 25;
  bool still = false;  ///< the poster alone
};

/// Pictures and numbers of one scene, moment by moment the same for all runs.
struct Media {
  std::string mp4;                              ///< H.264; "" of a still, and without ffmpeg
  std::string poster;                           ///< the moment of the greatest difference
  std::string poster_type;                      ///< "image/jpeg", or "image/png" without ffmpeg
  double poster_t = 0;                          ///< s
  std::vector<double> t;                        ///< s, of each frame
  std::vector<std::vector<double>> rms_strain;  ///< [run][frame]
  ColourScale scale;                            ///< of the pictures
};

/// Draws the runs. Throws InputError without a renderer. Precondition: one to kMostPanels runs.
Media render_media(const Scene&, const std::vector<RecordedRun>&, const MediaOptions&);

}  // namespace taut
