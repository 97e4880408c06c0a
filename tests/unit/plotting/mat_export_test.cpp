// SPDX-License-Identifier: Apache-2.0
#include "plotting/mat_export.h"

#include <gtest/gtest.h>
#include <matio.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>

namespace slew::plotting {
namespace mat_export_test {

const MatOrigin kOrigin = {"crane", "bench", "00ff", "0.1.0-test", 0.001};

class MatExport : public ::testing::Test {
 protected:
  MatExport() {
    std::string pattern = (std::filesystem::temp_directory_path() / "slewring-mat-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~MatExport() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

struct Close {
  void operator()(mat_t* file) const { Mat_Close(file); }
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

std::unique_ptr<matvar_t, Close> read(const std::filesystem::path& path, const char* name) {
  const std::unique_ptr<mat_t, Close> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  return std::unique_ptr<matvar_t, Close>(file ? Mat_VarRead(file.get(), name) : nullptr);
}

std::string text_of(matvar_t* variable, const char* field) {
  const matvar_t* found = Mat_VarGetStructFieldByName(variable, field, 0);
  if (found == nullptr || found->class_type != MAT_C_CHAR) return "no text";
  return std::string(static_cast<const char*>(found->data), found->nbytes);
}

std::vector<double> numbers_of(matvar_t* variable, const char* field) {
  const matvar_t* found = Mat_VarGetStructFieldByName(variable, field, 0);
  EXPECT_TRUE(found != nullptr && found->class_type == MAT_C_DOUBLE && found->rank == 2);
  if (found == nullptr) return {};
  EXPECT_EQ(found->dims[1], 1u);
  const auto* values = static_cast<const double*>(found->data);
  return {values, values + found->dims[0]};
}

TEST_F(MatExport, GivesBackNameUnitTimeAndValueToTheLastBit) {
  std::vector<Series> series = {{"Cyl_Lift.force", "N", {}, {}}, {"Input_Lift.raw", "", {0, 0.5}, {-1, 1}}};
  double x = 0.37;
  for (int i = 0; i < 20'000; ++i) {
    x = 3.9 * x * (1 - x);
    series[0].time.push_back(i * 1e-3);
    series[0].values.push_back(std::ldexp(x, i % 2000 - 1000));
  }
  series[0].values[3] = std::numeric_limits<double>::infinity();
  ASSERT_EQ(export_mat(series, kOrigin, file("a.mat")).text, "");
  const auto force = read(file("a.mat"), "Cyl_Lift_force");
  ASSERT_NE(force, nullptr);
  EXPECT_EQ(text_of(force.get(), "name"), "Cyl_Lift.force");
  EXPECT_EQ(text_of(force.get(), "unit"), "N");
  EXPECT_EQ(numbers_of(force.get(), "time"), series[0].time);
  EXPECT_EQ(numbers_of(force.get(), "value"), series[0].values);
  const auto lever = read(file("a.mat"), "Input_Lift_raw");
  ASSERT_NE(lever, nullptr);
  EXPECT_EQ(text_of(lever.get(), "unit"), "1");
  EXPECT_EQ(numbers_of(lever.get(), "value"), series[1].values);
  const auto origin = read(file("a.mat"), "recording");
  ASSERT_NE(origin, nullptr);
  EXPECT_EQ(text_of(origin.get(), "scene"), "crane");
  EXPECT_EQ(text_of(origin.get(), "session_id"), "00ff");
  EXPECT_EQ(numbers_of(origin.get(), "step"), std::vector<double>{0.001});
}

TEST_F(MatExport, KeepsACurveWithoutValues) {
  const std::vector<Series> series = {{"a", "m", {}, {}}, {"b", "m", {1}, {2}}};
  ASSERT_EQ(export_mat(series, kOrigin, file("a.mat")).text, "");
  EXPECT_TRUE(read(file("a.mat"), "a") != nullptr);
  EXPECT_EQ(numbers_of(read(file("a.mat"), "b").get(), "value"), std::vector<double>{2});
}

TEST_F(MatExport, TheSameCurvesGiveTheSameBytes) {
  const std::vector<Series> series = {{"a", "m", {0, 1}, {2, 3}}};
  std::string contents[2];
  for (std::string& content : contents) {
    ASSERT_EQ(export_mat(series, kOrigin, file("a.mat")).text, "");
    std::ifstream in(file("a.mat"), std::ios::binary);
    content.assign(std::istreambuf_iterator<char>(in), {});
  }
  EXPECT_EQ(contents[0], contents[1]);
  EXPECT_TRUE(contents[0].starts_with("MATLAB 5.0 MAT-file")) << "what readers look for";
}

TEST_F(MatExport, NamesAreValidInMatlabAndNoneComesTwice) {
  const std::string long_name(70, 'q');
  std::vector<Series> series;
  for (const std::string& name :
       {std::string("Bag.position.y"), std::string("Bag position-y"), std::string("2nd"), std::string("end"),
        std::string("recording"), std::string("_x"), long_name, long_name + "r", std::string("\xc3\xa4")}) {
    series.push_back({name, "", {}, {}});
  }
  EXPECT_EQ(mat_names(series),
            (std::vector<std::string>{"Bag_position_y", "Bag_position_y_2", "x2nd", "xend", "recording_2", "x_x",
                                      std::string(63, 'q'), std::string(61, 'q') + "_2", "x__"}));
}

TEST_F(MatExport, AWriteErrorIsReported) {
  const std::vector<Series> series = {{"a", "m", {0}, {1}}};
  const Status nowhere = export_mat(series, kOrigin, file("none/a.mat"));
  EXPECT_EQ(nowhere.code, ExitCode::storage);
  EXPECT_NE(nowhere.text.find("none/a.mat: the MAT-file cannot be written"), std::string::npos) << nowhere.text;
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "/dev/full is missing here";
  EXPECT_EQ(export_mat(series, kOrigin, "/dev/full").code, ExitCode::storage);
}

}  // namespace mat_export_test
}  // namespace slew::plotting
