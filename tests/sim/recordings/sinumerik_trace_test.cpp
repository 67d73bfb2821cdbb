#include "sim/recordings/sinumerik_trace.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/text.h"

namespace servomill::sim::recordings::sinumerik_trace_test {
namespace {

using Values = std::vector<double>;

const std::string kHead =
    "<?xml version=\"1.0\"?>\n<sessionData><traceData><dataFrame>\n"
    "<dataSignal id=\"1\" interval=\"0.002\" name=\"/Nck/a\" description=\"Actual\" "
    "unitsType=\"mm\"/>\n"
    "<dataSignal id=\"2\" interval=\"0.002\" name=\"/Nck/b\" description=\"Current\" "
    "unitsType=\"A\"/>\n";
const std::string kTail = "</dataFrame></traceData></sessionData>\n";

std::string refusal(const std::string& text) {
  try {
    parse_sinumerik_trace(text, "a.xml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SinumerikTrace, MissingValuesAreTheOnesBefore) {
  const std::string text = kHead +
                           "<rec time=\"0\" f1=\"1.5\"/>\n<rec time=\"0.002\" f2=\"-3\"/>\n"
                           "<rec time=\"0.004\" f1=\"9.2188684372274053e+18\"/>\n"
                           "<rec time=\"0.006\" f1=\"2.5\" f2=\"4\"/>\n" +
                           kTail;
  EXPECT_TRUE(is_sinumerik_trace(text));
  const Recording recording = parse_sinumerik_trace(text, "a.xml");
  ASSERT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.channels[0].name, "Actual");
  EXPECT_EQ(recording.channels[0].unit, "mm");
  EXPECT_EQ(recording.channels[0].samples, (Values{1.5, 1.5, 1.5, 2.5}));
  EXPECT_EQ(recording.channels[1].unit, "A");
  EXPECT_TRUE(std::isnan(recording.channels[1].samples[0]));  // nothing before
  EXPECT_EQ(recording.channels[1].samples[1], -3.0);
  EXPECT_EQ(recording.channels[1].samples[2], -3.0);
  EXPECT_EQ(recording.bases[0].values, (Values{0.0, 0.002, 0.004, 0.006}));
}

TEST(SinumerikTrace, EqualDescriptionsGiveWayToNames) {
  const Recording recording = parse_sinumerik_trace(
      "<traceData><dataFrame><dataSignal name=\"/a\" description=\"x\"/><dataSignal "
      "name=\"/b\" description=\"x\"/><dataSignal/><rec time=\"0\" f1=\"1\" f2=\"2\" f3=\"3\"/>"
      "</dataFrame></traceData>",
      "a.xml");
  EXPECT_EQ(recording.channels[0].name, "/a");
  EXPECT_EQ(recording.channels[1].name, "/b");
  EXPECT_EQ(recording.channels[2].name, "f3");
}

TEST(SinumerikTrace, BadInput) {
  const std::string first = kHead + "<rec time=\"0.002\" f1=\"1\"/>\n";
  EXPECT_EQ(refusal(first), "a.xml:5: error: is not complete XML: Start-end tags mismatch");
  EXPECT_EQ(refusal("<a><traceData/></a>"), "a.xml: error: contains no channel");
  EXPECT_EQ(refusal("<traceData><dataFrame/></traceData>"),
            "a.xml:1: error: <dataFrame>: has no dataSignal");
  EXPECT_EQ(refusal(kHead + kTail), "a.xml:2: error: <dataFrame>: has no rec");
  EXPECT_EQ(refusal(first + "<rec f1=\"1\"/>" + kTail), "a.xml:6: error: <rec>: has no time");
  EXPECT_EQ(refusal(first + "<rec time=\"0.001\"/>" + kTail),
            "a.xml:6: error: <rec>: time runs backwards: 0.001 s after 0.002 s");
  EXPECT_EQ(refusal(first + "<rec time=\"0.002\"/>" + kTail),
            "a.xml:6: error: <rec>: time 0.002 s appears twice");
  EXPECT_EQ(refusal(first + "<rec time=\"0.004\" f2=\"on\"/>" + kTail),
            "a.xml:6: error: <rec>: 'f2' is 'on', which is not a number");
  EXPECT_EQ(refusal(first + "<rec time=\"0.004\" f3=\"1\"/>" + kTail),
            "a.xml:6: error: <rec>: 'f3' in a frame of 2 signals");
}

}  // namespace
}  // namespace servomill::sim::recordings::sinumerik_trace_test
