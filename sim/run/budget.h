/// Error budget of a case: what each cause has of a residual, found by running the scenario again
/// without it.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/engine/stop_flag.h"
#include "sim/model/forward.h"
#include "sim/model/quantity_spec.h"
#include "sim/records/stored_signal.h"
#include "sim/run/budget_causes.h"
#include "sim/run/budget_estimate.h"

namespace servomill::sim::run {

/// A signal of a budget, um, at all places of it.
struct BudgetSignal {
  records::StoredSignal signal;
  double at_place = 0.0;  // signed, where the residual is largest
  double rms = 0.0;       // along the path
};

/// One cause of a residual.
struct BudgetPart : BudgetSignal {
  Cause cause = Cause::lag;
  bool present = false;  // the case has it; else all is 0, and no signal stored
  BudgetSignal share;    // with half of each of its pairs (9); where pairs were looked for
};

/// Joint effect of two causes, beside what each has alone.
struct BudgetPair : BudgetSignal {
  std::array<Cause, 2> causes{};
};

/// With R the residual along the path, R(-c) that of a run without the causes c and R(c) that of a
/// run with no others, at equal arc length (where the tip stands, at an equal share of what rotary
/// axes turn meanwhile); m = measurement, i = interpolation, l = lag, d = delay:
///
///     part(rest) = R()                                                                     (1)
///     part(i)    = R(i) - R()                                                              (2)
///     part(l)    = R(i, l) - R(i)                                                          (3)
///     part(d)    = R(i, l, d) - R(i, l)                                                    (4)
///     part(m)    = R - R(-m)                                                               (5)
///     part(c)    = R(-m) - R(-m, -c)                    for all others                     (6)
///     remainder  = R - sum of the parts
///                = R(-m) - R(i, l, d) - sum of (6)                                         (7)
///
/// Everything goes through interpolation, loops and delays. Without them, a cause would not come
/// out as it does: R(-l) differs from R by what the loops make of all causes, which (6) counts with
/// those. So (2) to (4) ask what they do to the program alone, one after the other as the signal
/// goes, and (6) what a cause adds to the outcome. Where loops are linear and causes add to what
/// they are given, the parts then add up. Following errors, say, begin behind the interpolation:
/// it has no part in them, although other tolerances make other speeds, and those other errors.
///
/// (6) takes causes away one at a time and not one after the other: parts do then not depend on an
/// order, and what two of them do together is in both, or in none. So it shows in the remainder
/// (which is 0 where there is but one); removed in turn, parts would add up exactly and the last
/// ones would hide it. m is taken away first, since the steps of encoders (some 20 nm) would be in
/// every other difference.
///
/// If the remainder is more than a tenth of the residual and 0.05 um (rms), pairs of the causes in
/// (6) are taken away, too, and show which of them make it:
///
///     pair(a, b) = R(-m) - R(-m, -a, -b) - part(a) - part(b)                              (8)
///
/// Its sum over all pairs is the remainder, but for what three causes do together (and what the
/// chain does with them): `unexplained`. A signal like x = a + b + I(a, b) has the part a + I(a, b)
/// for either, the remainder -I(a, b) and the pair -I(a, b).
///
/// Half of each pair then is the share of either of its causes:
///
///     share(c) = part(c) + sum over b of pair(c, b) / 2      for causes in (6)
///              = part(c)                                     for all others                (9)
///     R        = sum of the shares + unexplained                                          (10)
///
/// In the example x above, a has the share a + I(a, b) / 2. (9) is the Shapley value of the causes
/// in (6) where they interact in pairs alone: what a cause adds, averaged over all orders in which
/// causes can be added. So shares depend on no order either; what is left is what three causes and
/// more do together. Source: L. S. Shapley, A value for n-person games, Annals of Mathematics
/// Studies 28 (1953).
///
/// The rest (1) is `imposed` where a strategy moves the tool on purpose (generates errors, bends
/// the path) and the quantity does not take that off, else `uncorrectable` where one knows errors,
/// else `uncorrected`: the imposed displacement that imposed_error_residual wants and nobody brings
/// out.
///
/// Signals are computed sample by sample, from recordings that may lie on the disk, and kept there
/// themselves when they are long.
struct Budget {
  model::QuantitySpec quantity;  // of one case; a signal along the path (PathSignal)
  records::StoredSignal s;       // mm, of the original path
  records::StoredSignal turned;  // as in PathSample
  BudgetSignal residual;
  std::size_t place = 0;  // index of its largest value
  double place_s = 0.0;   // mm
  std::array<BudgetPart, kCauses> parts;
  BudgetSignal remainder;
  std::vector<BudgetPair> pairs;  // largest first; of remainders that are too large
  BudgetSignal unexplained;       // remainder less pairs
  std::string note;               // why there is none: "case table stopped: ..."

  /// True if the remainder is so large that its pairs are looked for.
  bool has_large_remainder() const;
  double sum_at_place() const { return residual.at_place - remainder.at_place; }
  /// Sum of the parts of a group at the place, um; empty if the case has no cause of it.
  std::optional<double> group_at_place(CauseGroup group) const;
  /// The same of their shares (9). @pre there are pairs
  std::optional<double> group_share_at_place(CauseGroup group) const;
};

struct BudgetControl {
  unsigned threads = 0;  // 0: one a core
  const engine::StopFlag* stop = nullptr;
  std::function<void(const BudgetEstimate&)> prepared;  // before the first run begins
  std::string scratch_folder;                           // as in RunControl
};

/// Budgets of quantities, in their order; runs each case with and without each cause that it has.
/// @param quantities  of one case each, as budget_quantities gives them
/// @return empty if it was stopped
/// @throws InputError before anything is simulated
std::vector<Budget> find_budgets(const model::Scenario& scenario,
                                 std::span<const model::QuantitySpec> quantities,
                                 const BudgetControl& control = {});

}  // namespace servomill::sim::run
