#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/metrics/metric.hpp"

// The fields of a record, a row for each. The table makes its JSON (record_io), its row in a
// results file (experiments/results), its axis in a chart, `taut list record` and, by
// tests/cli/keys_test.py --write, the tables of the documents. A new field is a member of Record, a
// row here and its value in run_case.cpp; the line that RecordLine.IsThisOneLine expects shows it.
// `taut export` (study_csv.cpp) and the page (report/model/cases.cpp) choose their fields
// themselves. Raise kRecordSchema and kSchemaVersion once per release that adds fields: every
// stored result is then computed again. Another name in JSON raises kRecordSchema alone, and stored
// results stay valid.

namespace taut {

struct RecordColumn {
  using Texts = std::map<std::string, std::string>;
  using Numbers = std::map<std::string, double>;
  using Member =
      std::variant<std::string Record::*, double Record::*, int Record::*, std::size_t Record::*,
                   std::vector<std::string> Record::*, Texts Record::*, Numbers Record::*,
                   std::vector<PassCost> Record::*, ResolvedSettings Record::*,
                   std::string CaseSpec::*, SceneSettings CaseSpec::*, Status::Kind Status::*,
                   StatusReason Status::*, int Status::*>;

  std::string_view json;    ///< its key; "status.kind": "kind" in the object "status"
  std::string_view column;  ///< in the table `cases`; "": the field has its own table
  Member member;
  std::string_view help;        ///< one line
  bool is_result = false;       ///< part of result_digest(): the same key must always give the same
  bool may_lack = false;        ///< optional: -1 is stored as NULL; "" is left out of the JSON
  std::string_view title = "";  ///< of an axis of a chart; "": the field is on none
  Unit unit = kNumber;

  std::string_view type() const;  ///< "text", "number", "whole number", "JSON"
  bool may_be_null() const { return may_lack && type() == "whole number"; }
  bool may_be_absent() const { return may_lack && type() == "text"; }
};
/// All columns, in the order of the documents.
std::span<const RecordColumn> record_columns();
/// The column of this JSON key that may be an axis of a chart; null: there is none.
const RecordColumn* find_axis(std::string_view json);
/// The record's number in this column; NaN if the record lacks it.
double number_in(const Record&, const RecordColumn&);

/// A field of a record that was read back with an impossible value. The field has the same name in
/// JSON and in a results file.
struct ImpossibleField {
  const char *name, *why;
};
/// A key that is no digest (is_key), or a time step that is not above 0.
std::optional<ImpossibleField> impossible_field(const Record&);

// A column's member of a record, const as the record is.
template <class AnyRecord, class Value>
auto& member_of(AnyRecord& r, Value Record::*member) {
  return r.*member;
}
template <class AnyRecord, class Value>
auto& member_of(AnyRecord& r, Value CaseSpec::*member) {
  return r.spec.*member;
}
template <class AnyRecord, class Value>
auto& member_of(AnyRecord& r, Value Status::*member) {
  return r.status.*member;
}
/// Returns use(the column's member of the record), of whichever type.
template <class AnyRecord, class Use>
auto with_member(AnyRecord& record, const RecordColumn& column, const Use& use) {
  return std::visit([&](auto member) { return use(member_of(record, member)); }, column.member);
}

}  // namespace taut
