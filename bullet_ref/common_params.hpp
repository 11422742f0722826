#pragma once

#include "core/model/params.hpp"

namespace taut::bullet_param {

/// What both of Bullet's cloths take.
inline constexpr ParamSpec substeps = {
    .name = "substeps",
    .kind = ParamSpec::Kind::integer,
    .default_value = "1",
    .min = 1,
    .max = 1e6,
    .help = "each step is this many calls of stepSimulation(dt / substeps)"};
inline constexpr ParamSpec precision = {.name = "precision",
                                        .kind = ParamSpec::Kind::choice,
                                        .default_value = "double",
                                        .choices = "float|double",
                                        .help = "which build of Bullet; float runs in taut-f32"};
inline constexpr ParamSpec margin = {
    .name = "margin",
    .kind = ParamSpec::Kind::real,
    .unit = "m",
    .default_value = "0",
    .min = 0,
    .max = 1,
    .help = "collision margin on top of the scene's thickness (Bullet's default: 0.25)"};

}  // namespace taut::bullet_param
