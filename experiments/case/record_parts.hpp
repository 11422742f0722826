#pragma once

#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/system/json.hpp"

namespace taut {

// Conversions between JSON and the values of a record's columns that are neither numbers nor texts.
// The JSON library finds to_json by its name; read_into throws InputError.
void to_json(Json&, const PassCost&);
void to_json(Json&, const SceneSetting&);
void to_json(Json&, const ResolvedSetting&);
void to_json(Json&, const Status::Kind&);
void to_json(Json&, const StatusReason&);
void read_into(const JsonReader&, Status::Kind&);
void read_into(const JsonReader&, StatusReason&);
void read_into(const JsonReader&, std::vector<PassCost>&);
void read_into(const JsonReader&, SceneSettings&);
void read_into(const JsonReader&, ResolvedSettings&);

}  // namespace taut
