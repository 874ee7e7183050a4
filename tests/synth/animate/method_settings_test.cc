#include "synth/animate/method_settings.h"

#include <set>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/harness/fault.h"

namespace freshet::synth::animate {
namespace {

/// A value that is right and not `now`.
std::string other_value(const MethodSetting& setting, const std::string& now) {
  if (!setting.words.empty())
    return setting.words.front() != now ? setting.words.front() : setting.words.back();
  return std::stod(now) != setting.max ? std::to_string(setting.max) : std::to_string(setting.min);
}

std::string fault_of(const MethodSetting& setting, Method method, const std::string& value) {
  return fault_of(ErrorKind::kUsage, [&] { setting.set(method, value); });
}

TEST(MethodSettings, EachChangesItsOwnFieldAndNoOther) {
  for (const Method& method : {Method(CarriedOptions{}), Method(FormsOptions{}), Method(PaperOptions{})})
    for (const MethodSetting& setting : method_settings()) {
      if (setting.name == "method" || !setting.value(method)) continue;
      Method changed = method;
      const std::string value = other_value(setting, *setting.value(method));
      setting.set(changed, value);
      EXPECT_NE(setting.value(changed), setting.value(method)) << setting.name;
      for (const MethodSetting& other : method_settings()) {
        if (other.name == setting.name) continue;
        EXPECT_EQ(other.value(changed), other.value(method)) << other.name;
      }
    }
}

TEST(MethodSettings, DefaultsAreThoseOfTheOptions) {
  EXPECT_EQ(default_value(method_setting("method")), "carried");
  EXPECT_EQ(default_value(method_setting("renewal")), "1");
  EXPECT_EQ(default_value(method_setting("matching")), "sequence");
  EXPECT_EQ(default_value(method_setting("shutter")), "0.35");
}

TEST(MethodSettings, AMethodRefusesWhatItDoesWithout) {
  for (const char* name : {"low-band", "matching", "max-gain"}) {
    const std::string fault =
        fault_of(method_setting(name), CarriedOptions{}, default_value(method_setting(name)));
    EXPECT_NE(fault.find(name), std::string::npos) << fault;
    EXPECT_NE(fault.find("paper"), std::string::npos) << fault;
  }
  for (const char* name : {"variation", "renewal", "standing", "detail-life"})
    EXPECT_NE(fault_of(method_setting(name), PaperOptions{}, "1"), "") << name;
  EXPECT_NE(fault_of(method_setting("renewal"), CarriedOptions{.innovations = std::nullopt}, "1"), "");
}

TEST(MethodSettings, WrongValuesAreRefusedByName) {
  for (const char* value : {"", "x", "nan", "1.5x", "-1", "1e9"}) {
    const std::string fault = fault_of(method_setting("renewal"), CarriedOptions{}, value);
    EXPECT_NE(fault.find("renewal"), std::string::npos) << value;
  }
  EXPECT_NE(fault_of(method_setting("blend"), CarriedOptions{}, "none").find("variance, paper"),
            std::string::npos);
  EXPECT_THROW(method_setting("nothing"), Error);
}

TEST(MethodSettings, AnotherMethodBeginsWithItsDefaults) {
  Method method = CarriedOptions{};
  method_setting("shutter").set(method, "2");
  method_setting("method").set(method, "paper");
  ASSERT_TRUE(std::holds_alternative<PaperOptions>(method));
  EXPECT_EQ(method_setting("shutter").value(method), default_value(method_setting("shutter")));
}

TEST(MethodSettings, NamesAreDistinctAndTextsAreThere) {
  std::set<std::string> names;
  for (const MethodSetting& setting : method_settings()) {
    EXPECT_TRUE(names.insert(setting.name).second) << setting.name;
    EXPECT_FALSE(setting.text.empty()) << setting.name;
    EXPECT_FALSE(methods_with(setting).empty()) << setting.name;
  }
}

}  // namespace
}  // namespace freshet::synth::animate
