#include "sim/recordings/sinumerik_frequency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/base85.h"
#include "sim/recordings/fourier.h"
#include "sim/recordings/survey.h"
#include "sim/recordings/xml_document.h"

namespace servomill::sim::recordings {
namespace {

using Complex = std::complex<double>;
using Series = std::vector<std::vector<double>>;

constexpr std::size_t kMaxSamples = 1 << 15;  // of series that are transformed again

// Spectrum as the control computed it.
struct Spectrum {
  std::string signal, other;  // node numbers; other: empty for an auto spectrum
  std::vector<Complex> values;
  std::vector<double> frequencies;
};

// Mean over the series of conj(X) Y, in the scaling of the control; nothing if they do not fit.
std::vector<Complex> mean_product(const Series& x, const Series& y, std::size_t lines) {
  std::vector<Complex> out(lines);
  for (std::size_t s = 0; s < x.size(); ++s) {
    const auto X = fourier_lines(x[s], lines), Y = fourier_lines(y[s], lines);
    const double count = static_cast<double>(x[s].size());
    const double scale = 4.0 / (count * count * static_cast<double>(x.size()));
    for (std::size_t k = 0; k < lines; ++k) out[k] += scale * std::conj(X[k]) * Y[k];
  }
  return out;
}

class FrequencyFile {
 public:
  FrequencyFile(std::string_view text, const std::string& file) : document_(text, file) {
    out_.file = file;
    out_.format = "Sinumerik frequency measurement";
  }

  Recording read() {
    const pugi::xml_node root = document_.child("ResponseTestCustom");
    const auto nodes = named(root, "LinkedList", "m_MeasurementSignalNodeList");
    for (const pugi::xml_node node : nodes.children("PlatformSignalNode")) read_node(node);
    for (const Spectrum& spectrum : spectra_) add(spectrum);
    note_axis_error();
    note_responses();
    return std::move(out_);
  }

 private:
  static pugi::xml_node named(pugi::xml_node parent, const char* element, const char* name) {
    return parent.find_child_by_attribute(element, "name", name);
  }

  std::string number_text(pugi::xml_node parent, const char* name) const {
    return named(parent, "unsigned_int", name).child_value();
  }

  double number(pugi::xml_node parent, const char* element, const char* name) const {
    return document_.number(named(parent, element, name), name);
  }

  void read_node(pugi::xml_node node) {
    const std::string id = number_text(node, "m_uNodeId");
    const auto list = named(node, "LinkedList", "m_TimeSeriesList");
    for (const pugi::xml_node one : list.children("TimeSeries")) read_series(one, id);
    for (const pugi::xml_node one : node.children("SigNodeCrossSpectrumInfo")) read_spectrum(one);
    const auto crosses = named(node, "LinkedList", "m_crossSpecInfoList");
    for (const pugi::xml_node one : crosses.children("SigNodeCrossSpectrumInfo")) {
      read_spectrum(one, id);
    }
  }

  // Numbers of an array; complex ones interleaved.
  std::vector<double> array(pugi::xml_node parent, const char* name) const {
    const auto node = named(parent, "NumericArray", name);
    if (!node) document_.fail(parent, fmt::format("has no array '{}'", name));
    std::string why;
    auto out = base85_doubles(named(node, "raw", "m_pNumberArray").child_value(), why);
    if (!why.empty()) document_.fail(node, fmt::format("array '{}': {}", name, why));
    const bool is_complex =
        std::string_view(node.attribute("elementtype").value()) == "ComplexNumber";
    const double length = number(node, "unsigned_int", "m_length");
    if (static_cast<double>(out.size()) != length * (is_complex ? 2.0 : 1.0)) {
      document_.fail(node, fmt::format("array '{}' has {} numbers for a length of {}", name,
                                       out.size(), length));
    }
    return out;
  }

  void read_series(pugi::xml_node node, const std::string& id) {
    std::vector<double> samples = array(node, "m_ValueVector");
    const double start = number(node, "float", "m_TimeVector.start");
    const double end = number(node, "float", "m_TimeVector.end");
    if (samples.size() < 2 || !(end > start)) document_.fail(node, "is a series without duration");
    Base base;
    const double step = (end - start) / static_cast<double>(samples.size() - 1);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      base.values.push_back(start + static_cast<double>(i) * step);
    }
    const std::size_t index = base_index(std::move(base));
    Series& all = series_[id];
    all.push_back(samples);
    out_.channels.push_back(
        {fmt::format("signal {} series {}", id, all.size()), "", std::move(samples), index});
  }

  void read_spectrum(pugi::xml_node node, const std::string& id = "") {
    const auto average = named(node, "CrossSpectrum", "m_avgCrossSpec");
    if (!average) document_.fail(node, "has no averaged spectrum");
    const std::string of = number_text(node, "m_uSignodeId");
    Spectrum out{
        id.empty() ? of : id, id.empty() ? "" : of, {}, array(average, "m_FrequencyVector")};
    const std::vector<double> values = array(average, "m_ValueVector");
    if (values.size() != 2 * out.frequencies.size()) {
      document_.fail(average, fmt::format("has {} values at {} frequencies", values.size() / 2,
                                          out.frequencies.size()));
    }
    for (std::size_t k = 0; k < values.size(); k += 2)
      out.values.emplace_back(values[k], values[k + 1]);
    spectra_.push_back(std::move(out));
  }

  // The base with these values, a new one if there is none.
  std::size_t base_index(Base base) {
    for (std::size_t i = 0; i < out_.bases.size(); ++i) {
      if (out_.bases[i].unit == base.unit && out_.bases[i].values == base.values) return i;
    }
    out_.bases.push_back(std::move(base));
    return out_.bases.size() - 1;
  }

  void add(const Spectrum& spectrum) {
    const std::size_t base = base_index({"frequency", "Hz", spectrum.frequencies});
    Channel real{fmt::format("signal {} auto spectrum", spectrum.signal), "", {}, base};
    if (!spectrum.other.empty()) {
      real.name = fmt::format("signal {} {} cross spectrum re", spectrum.signal, spectrum.other);
    }
    Channel imaginary{
        fmt::format("signal {} {} cross spectrum im", spectrum.signal, spectrum.other),
        "",
        {},
        base};
    for (const Complex& value : spectrum.values) {
      real.samples.push_back(value.real());
      imaginary.samples.push_back(value.imag());
    }
    out_.channels.push_back(std::move(real));
    if (!spectrum.other.empty()) out_.channels.push_back(std::move(imaginary));
  }

  const Base* base_of(const char* unit) const {
    for (const Base& base : out_.bases) {
      if (base.unit == unit && base.values.size() > 1) return &base;
    }
    return nullptr;
  }

  void note_axis_error() {
    const Base* time = base_of("s");
    const Base* frequency = base_of("Hz");
    if (time == nullptr || frequency == nullptr) return;
    const double duration = interval(*time) * static_cast<double>(time->values.size());
    const double line = interval(*frequency);
    out_.notes.push_back(fmt::format(
        "the frequency axis of the control has {:.5g} Hz per line; the transform of {} samples at "
        "{:.6g} us has {:.5g} Hz: {:+.3f} %",
        line, time->values.size(), interval(*time) * 1e6, 1.0 / duration,
        100.0 * (line * duration - 1.0)));
  }

  const Spectrum* auto_spectrum(const std::string& signal) const {
    for (const Spectrum& one : spectra_) {
      if (one.signal == signal && one.other.empty()) return &one;
    }
    return nullptr;
  }

  static bool can_transform(const Series& x, const Series& y, std::size_t lines) {
    if (x.empty() || x.size() != y.size()) return false;
    for (std::size_t s = 0; s < x.size(); ++s) {
      if (x[s].size() != y[s].size() || x[s].size() > kMaxSamples || lines > x[s].size())
        return false;
    }
    return true;
  }

  // Response of each signal to the one that its cross spectrum names.
  void note_responses() {
    for (const Spectrum& cross : spectra_) {
      const Spectrum* input = cross.other.empty() ? nullptr : auto_spectrum(cross.other);
      const std::size_t lines = cross.values.size();
      if (input == nullptr || input->values.size() != lines) continue;
      const Series &x = series_[cross.signal], &y = series_[cross.other];
      if (!can_transform(x, y, lines)) continue;
      const auto S_xy = mean_product(x, y, lines), S_yy = mean_product(y, y, lines);
      double difference = 0.0, greatest = 0.0, of_line = 0.0;
      for (std::size_t k = 0; k < lines; ++k) {
        const Complex of_control = std::conj(cross.values[k]) / input->values[k];
        const Complex own = std::conj(S_xy[k]) / S_yy[k];
        greatest = std::max(greatest, std::abs(of_control));
        difference = std::max(difference, std::abs(own - of_control));
        of_line = std::max(of_line, std::abs(own - of_control) / std::abs(of_control));
      }
      out_.notes.push_back(fmt::format(
          "response of signal {} to {}: the transform of the series differs from the control's by "
          "{:.1e} of the largest response and by at most {:.1e} of the response at the same line",
          cross.signal, cross.other, difference / greatest, of_line));
    }
  }

  XmlDocument document_;
  Recording out_;
  std::map<std::string, Series> series_;
  std::vector<Spectrum> spectra_;
};

}  // namespace

bool is_sinumerik_frequency(std::string_view text) {
  constexpr std::size_t kHead = 4096;
  return is_xml(text) &&
         text.substr(0, kHead).find("<ResponseTestCustom") != std::string_view::npos;
}

Recording parse_sinumerik_frequency(std::string_view text, const std::string& file) {
  Recording out = FrequencyFile(text, file).read();
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
