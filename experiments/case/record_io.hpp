#pragma once

#include <string>
#include <string_view>

#include "experiments/case/record.hpp"
#include "experiments/case/run_case.hpp"

namespace taut {

class JsonReader;

/// Whether it ran to its end without an extreme, so that its values may be compared and averaged.
bool completed(const Status&);
/// Whether the solver tried and has no value. A scene that it refuses beforehand is no failure.
bool failed(const Status&);

/// "exploded (energy) at step 12, vertex 3".
std::string describe(const Status&);

/// Version of every JSON text below; readers refuse others.
inline constexpr int kRecordSchema = 3;

/// One JSON object; doubles in shortest exact form, NaN as null. indent < 0: one line.
std::string to_json(const Record&, int indent = -1);
/// Throws InputError that names `where` (a file) if the text is not a record of this schema.
Record record_from_json(std::string_view text, const std::string& where);
/// The same of a part of another JSON text.
Record record_of(const JsonReader&);

/// Whether the text is the address of a case, 64 hexadecimal digits; no other text becomes part of
/// a path.
bool is_key(std::string_view);

/// SHA-256 of what was computed: status, values, step costs, resolved settings and final state.
/// The names of the case (spec, id, scene name) are left out: the same key must always give the
/// same digest.
std::string result_digest(const Record&);

/// CSV with a header line; doubles in shortest exact form, NaN as an empty field.
std::string to_csv(const Series&);
/// An object of columns: {"step": [0, 1], "t": [0, 0.1]}; NaN as null.
std::string to_json(const Series&);
/// Throws InputError that names `where`.
Series series_from_json(std::string_view text, const std::string& where);

/// "vertex,x,y,z,vx,vy,vz" and a line per vertex [m, m/s]; shortest exact form.
std::string to_csv(const State&);

}  // namespace taut
