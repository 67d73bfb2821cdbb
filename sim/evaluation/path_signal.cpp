#include "sim/evaluation/path_signal.h"

#include <cassert>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

// The tool stands from one place to another (mm) if both are the same but for rounding.
bool stands(double s, double later) { return later - s < 1e-7; }

}  // namespace

bool has_path_signal(std::string_view quantity) {
  const QuantityEntry* entry = find_quantity(quantity);
  return entry != nullptr && entry->signal != nullptr;
}

struct PathSignal::Parts {
  Parts(const model::QuantitySpec& spec, const CaseData& one, const CaseData* base)
      : rows(CaseSamples(one).rows(spec.sections)),
        at(rows),
        s(column_of(one, "s", '\0')),
        value(quantity_entry(spec.name).signal(spec, one, base)) {
    for (const char axis : std::string_view("ABC")) {
      if (AtRow ref = column_of(one, "ref_rotary", axis)) rotary.push_back(std::move(ref));
    }
  }

  // Rotation of the rotary axes from one row to another.
  double turn(std::size_t from, std::size_t to) const {
    double sum = 0.0;
    for (const AtRow& ref : rotary) sum += std::abs(ref(to) - ref(from));
    return sum;
  }

  // The same from a row until the tool moves on.
  double turn_while_standing(RowRanges::Cursor from) const {
    double sum = 0.0;
    while (!rotary.empty()) {
      const std::size_t row = from.row();
      from.step();
      if (from.is_at_end() || !stands(s(row), s(from.row()))) break;
      sum += turn(row, from.row());
    }
    return sum;
  }

  RowRanges rows;
  RowRanges::Cursor at;
  AtRow s, value;
  std::vector<AtRow> rotary;
  std::optional<std::size_t> before;   // row of the sample before
  double turned = 0.0, to_turn = 0.0;  // since the tool stands; in all until it moves on
};

PathSignal::PathSignal(const model::QuantitySpec& spec, const CaseData& one, const CaseData* base)
    : parts_(std::make_unique<Parts>(spec, one, base)) {
  assert(has_path_signal(spec.name));
}
PathSignal::PathSignal(PathSignal&&) noexcept = default;
PathSignal::~PathSignal() = default;

std::size_t PathSignal::size() const { return parts_->value ? parts_->rows.size() : 0; }

bool PathSignal::next(PathSample& sample) {
  Parts& p = *parts_;
  if (!p.value || p.at.is_at_end()) return false;
  const std::size_t row = p.at.row();
  sample.s = p.s(row);
  if (p.before && stands(p.s(*p.before), sample.s)) {
    p.turned += p.turn(*p.before, row);
  } else {
    p.turned = 0.0;
    p.to_turn = p.turn_while_standing(p.at);
  }
  sample.turned = p.to_turn > 0.0 ? p.turned / p.to_turn : 0.0;
  sample.value = p.value(row);
  p.before = row;
  p.at.step();
  return true;
}

}  // namespace servomill::sim::evaluation
