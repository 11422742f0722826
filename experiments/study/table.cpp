#include "experiments/study/table.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "experiments/case/record_io.hpp"

namespace taut {

namespace {

/// What tells the cases of one scene apart: "jakobsen:iterations=4 dt=1/120".
std::string setting_of(const Case& one, const Study& study) {
  std::string text = one.choice.brief();
  for (const std::string& change : one.spec.overrides)
    if (std::ranges::find(study.settings, change) == study.settings.end()) text += " " + change;
  return text;
}

std::string cell(const Record& record, const std::string& value) {
  if (!completed(record.status)) return std::string(to_string(record.status.kind));
  const auto at = record.values.find(value);
  if (at == record.values.end() || std::isnan(at->second)) return "-";
  std::ostringstream text;
  text << std::setprecision(3) << at->second
       << (record.status.kind == Status::Kind::unsettled ? " ~" : "");
  return text.str();
}

void add(std::vector<std::string>& names, const std::string& name) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

}  // namespace

StudyTable::StudyTable(StudyRecords known) {
  std::map<std::string, Record> by_key;
  for (Record& record : known.records) by_key[record.key] = std::move(record);
  for (const Case& one : known.cases) {
    const std::string setting = setting_of(one, known.study);
    add(settings_, setting), add(scenes_, one.scene->name);
    if (const auto at = by_key.find(one.key); at != by_key.end())
      records_[{setting, one.scene->name}] = at->second;
  }
}

std::string StudyTable::text(const std::string& value) const {
  std::size_t width = value.size();
  for (const std::string& setting : settings_) width = std::max(width, setting.size());
  const auto first = static_cast<int>(width + 2);
  std::ostringstream out;
  out << std::left << std::setw(first) << value;
  for (const std::string& scene : scenes_) out << std::setw(14) << scene;
  for (const std::string& setting : settings_) {
    out << '\n' << std::setw(first) << setting;
    for (const std::string& scene : scenes_) {
      const auto at = records_.find({setting, scene});
      out << std::setw(14) << (at == records_.end() ? "" : cell(at->second, value));
    }
  }
  out << '\n';
  return out.str();
}

}  // namespace taut
