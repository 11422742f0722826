// A [[collider]] that is a mesh: the meaning of its file and keys, and errors with file and line.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "core/model/triangle_mesh.hpp"
#include "tests/support/bodies.hpp"

namespace taut::body_io_test {
namespace {

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

class BodyFiles : public testing::Test {
 protected:
  BodyFiles() { std::filesystem::create_directories(folder_); }
  ~BodyFiles() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  Scene scene(const std::string& collider, const std::string& cloth = "") const {
    return parse_scene(folder_ / "x.toml",
                       "[cloth]\ngrid = [3, 3]\nsize = [1, 1]\norigin = [9, 9, 9]\n" + cloth +
                           "[[collider]]\ntype = \"mesh\"\n" + collider);
  }
  std::string errors(const std::string& collider, const std::string& cloth = "") const {
    try {
      scene(collider, cloth);
    } catch (const InputError& error) {
      std::string text = error.what();
      for (std::string folder = folder_.string() + "/"; text.find(folder) != text.npos;)
        text.replace(text.find(folder), folder.size(), "");
      return text;
    }
    return "";
  }
  std::string errors_of_file(const std::string& obj) const {
    write("b.obj", obj);
    return errors("file = \"b.obj\"\n");
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("taut_body_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(BodyFiles, KeysPlaceTheBody) {
  write("b.obj", kTetrahedron);
  const Scene s = scene(
      "file = \"b.obj\"\nscale = 0.5\ncenter = [1, 2, 3]\nrotation = { axis = [0, 0, 1], angle = "
      "90 }\nfriction = 0.25\nvelocity = [0, 0, 4]\n");
  const Collider& collider = s.colliders.at(0);
  const auto& body = std::get<MeshBody>(collider.shape);
  EXPECT_EQ(body.mesh->vertices(),
            (std::vector<Vec3>{{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}));
  EXPECT_EQ(body.mesh->triangles(),
            (std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}));
  EXPECT_EQ(body.center, Vec3(1, 2, 3));
  EXPECT_EQ(body.sides, MeshBody::Sides::out);
  EXPECT_NEAR((body.rotation * Vec3::UnitX() - Vec3::UnitY()).norm(), 0, 1e-15);
  EXPECT_EQ(collider.friction, 0.25);
  EXPECT_EQ(collider.motion.velocity, Vec3(0, 0, 4));
  EXPECT_EQ(collider.motion.pivot, Vec3(1, 2, 3));
  const Shape later = shape_at(collider, 2);
  EXPECT_EQ(std::get<MeshBody>(later).center, Vec3(1, 2, 11));
  // 0.1 m above the face that is at x = 0 in the file and is turned to y
  EXPECT_NEAR(surface(later, {0.9, 1.9, 11.1}).distance, 0.1, 1e-15);
}

TEST_F(BodyFiles, FacesThatLookInwardAreTurned) {
  write("b.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 0\nv 1 0 0\nvt 0 0\nf 1 2 3\nf 5 4 6\nf 1 3 4\n"
        "f 2 4 3\n");
  const Scene s = scene("file = \"b.obj\"\n");
  const auto& body = std::get<MeshBody>(s.colliders.at(0).shape);
  EXPECT_NEAR(body.mesh->volume(), 1.0 / 6, 1e-15);
  EXPECT_TRUE(body.mesh->closed());
}

/// The six faces of a box as an OBJ file has them, with vertices of its own; `first`: where the
/// corners of its faces along x begin.
std::string box_obj(const Vec3& from, const Vec3& to, int before, int first = 0) {
  std::string text;
  for (int v = 0; v < 8; ++v) {
    text += "v";
    for (int k = 0; k < 3; ++k) text += " " + shortest((v >> k & 1) != 0 ? to[k] : from[k]);
    text += "\n";
  }
  const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int f = 0; f < 6; ++f) {
    text += "f";
    for (int k = 0; k < 4; ++k)
      text += " " + std::to_string(before + 1 + faces[f][(k + (f < 2 ? first : 0)) % 4]);
    text += "\n";
  }
  return text;
}

TEST_F(BodyFiles, BoxesMayTouch) {
  const std::string box = box_obj({0, 0, 0}, {1, 1, 1}, 0);
  const auto body_of = [&](const std::string& other) {
    write("b.obj", box + other);
    const Scene s = scene("file = \"b.obj\"\n");
    return std::get<MeshBody>(s.colliders.at(0).shape).mesh;
  };
  const auto at_edge = body_of(box_obj({1, 1, 0}, {2, 2, 1}, 8));
  EXPECT_TRUE(at_edge->closed());
  EXPECT_EQ(at_edge->triangles().size(), 24u);
  EXPECT_NEAR(at_edge->volume(), 2, 1e-15);
  for (const int first : {0, 1, 2}) {  // the two faces are cut along other diagonals, or the same
    const auto at_face = body_of(box_obj({1, 0, 0}, {3, 1, 1}, 8, first));
    EXPECT_TRUE(at_face->closed());
    EXPECT_EQ(at_face->triangles().size(), 20u) << "the faces between them are left out";
    EXPECT_NEAR(at_face->volume(), 3, 1e-15);
    EXPECT_NEAR(at_face->nearest({1.01, 0.4, 0.45}).distance, -0.4, 1e-15);
  }
  const auto four =
      body_of(box_obj({1, 0, 0}, {2, 1, 1}, 8, 1) + box_obj({0, 1, 0}, {1, 2, 1}, 16) +
              box_obj({1, 1, 0}, {2, 2, 1}, 24, 1));
  EXPECT_EQ(four->triangles().size(), 48u - 16u);
  EXPECT_NEAR(four->nearest({1, 1.01, 0.4}).distance, -0.4, 1e-15);
  std::string cut = box_obj({1, 0, 0}, {2, 1, 1}, 8);
  cut.replace(cut.find("f 9 13 15 11"), 12, "f 9 13 11\nf 13 15 11");  // cut the other way
  EXPECT_SAYS(errors_of_file(box + cut), "an edge of the face") << "faces that lie on each other";
}

TEST_F(BodyFiles, ARoomIsToldHowToBeOne) {
  std::string room = box_obj({0, 0, 0}, {20, 20, 20}, 0);
  const std::string outward = room;
  for (std::size_t at = room.find("f "); at != room.npos; at = room.find("f ", at + 1)) {
    std::swap(room[at + 2], room[at + 6]);  // the faces look inward
  }
  EXPECT_SAYS(errors_of_file(room), "look inward, and were turned");
  EXPECT_SAYS(errors_of_file(room), "sides = \"both\"");
  EXPECT_EQ(errors_of_file(outward).find("sides"), std::string::npos);
  EXPECT_EQ(errors("file = \"b.obj\"\nsides = \"both\"\n", "thickness = 0.01\n"), "");
}

TEST_F(BodyFiles, TheContentIsThatOfTheTriangles) {
  write("b.obj", kTetrahedron);
  write("c.obj", "# the same\n" + std::string(kTetrahedron));
  write("d.obj", std::string(kTetrahedron).replace(4, 1, "0.001"));
  const std::string b = content(scene("file = \"b.obj\"\n"));
  EXPECT_EQ(content(scene("file = \"c.obj\"\n")), b);
  EXPECT_NE(content(scene("file = \"d.obj\"\n")), b);
  for (const char* other : {"scale = 2\n", "center = [1, 0, 0]\n", "friction = 0.1\n",
                            "rotation = { axis = [0, 0, 1], angle = 9 }\n"})
    EXPECT_NE(content(scene("file = \"b.obj\"\n" + std::string(other))), b) << other;
  const std::string thick = "thickness = 0.01\n";
  EXPECT_NE(content(scene("file = \"b.obj\"\nsides = \"both\"\n", thick)),
            content(scene("file = \"b.obj\"\n", thick)));
}

TEST_F(BodyFiles, WhatIsWrongWithAFileIsNamedByItsLine) {
  EXPECT_EQ(errors_of_file(kTetrahedron), "");
  EXPECT_SAYS(errors("file = \"none.obj\"\n"), "x.toml:7:");
  EXPECT_SAYS(errors(""), "'file'");
  EXPECT_SAYS(errors_of_file("v 0 0 0\n"), "b.obj:1:1: no face");
  EXPECT_SAYS(errors_of_file("v 0 0 nan\n"), "b.obj:1:7: 'nan' is not a coordinate");
  EXPECT_SAYS(errors_of_file(std::string(kTetrahedron) + "f 1 2 9\n"),
              "b.obj:9:1: the face names vertex 9");
  const std::string open = kTetrahedron;
  EXPECT_SAYS(errors_of_file(open.substr(0, open.size() - 8)), "b.obj:5:1: an edge of the face");
  EXPECT_SAYS(errors_of_file("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "b.obj:4:1: the face has no");
  // two corners at the same place
  EXPECT_SAYS(errors_of_file("v 0 0 0\nv 1 0 0\nv 0 0 0\nf 1 2 3\n"), "b.obj:4:1: ");
  // a sheet with two faces back to back
  EXPECT_SAYS(errors_of_file("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n"),
              "encloses no volume");
  write("b.obj", std::string(kTetrahedron).replace(10, 1, "2"));
  EXPECT_SAYS(errors("file = \"b.obj\"\nscale = 1e6\n"), "reaches farther");
}

TEST_F(BodyFiles, AllOfItIsSaidAtOnce) {
  write("b.obj", "v 0 0 nan\nv 1 0 0\nw\n");
  const std::string all = errors("file = \"b.obj\"\nscale = 0\nsides = \"in\"\n");
  for (const char* part : {"b.obj:1:7", "b.obj:3:1", "'scale'", "'sides'"}) EXPECT_SAYS(all, part);
}

TEST_F(BodyFiles, AnOpenBodyIsThinAndNeedsAThickness) {
  write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_SAYS(errors("file = \"b.obj\"\n"), "b.obj:4:1: an edge of the face");
  EXPECT_SAYS(errors("file = \"b.obj\"\nsides = \"both\"\n"), "'thickness'");
  EXPECT_EQ(errors("file = \"b.obj\"\nsides = \"both\"\n", "thickness = 0.01\n"), "");
}

TEST_F(BodyFiles, AClothThatStartsInsideIsRefusedOrMovedOut) {
  write("b.obj", kTetrahedron);
  const std::string inside = "file = \"b.obj\"\ncenter = [8.5, 8.9, 8.9]\nscale = 3\n";
  EXPECT_SAYS(errors(inside), "the cloth starts inside this mesh");
  const Scene moved = scene(inside, "start_inside = \"resolve\"\nthickness = 0.01\n");
  for (const Vec3& x : moved.start.x)
    EXPECT_GE(surface(moved.colliders[0].shape, x).distance, 0.01 - 1e-12);
}

/// NumPy array of frames: the tetrahedron shifted by each vector of `moved`.
std::string npy(const std::vector<Vec3>& moved, const std::string& type = "<f8",
                const std::string& shape = "", const std::string& order = "False") {
  const std::string real = shape.empty() ? "(" + std::to_string(moved.size()) + ", 4, 3)" : shape;
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + real + ", }";
  header.resize(117, ' ');
  header += '\n';
  std::string text("\x93NUMPY\1\0", 8);
  text += {static_cast<char>(header.size()), '\0'};
  text += header;
  for (const Vec3& by : moved)
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      for (const double c : Vec3(x + by)) {
        const auto single = static_cast<float>(c);
        if (type == "<f4")
          text.append(reinterpret_cast<const char*>(&single), sizeof single);
        else
          text.append(reinterpret_cast<const char*>(&c), sizeof c);
      }
  return text;
}

const std::string kWalking = "file = \"b.obj\"\nframes = \"w.npy\"\nfps = 2\n";

TEST_F(BodyFiles, FramesMoveTheVertices) {
  write("b.obj", kTetrahedron);
  for (const char* type : {"<f4", "<f8"}) {
    write("w.npy", npy({{0, 0, 0}, {1, 0, 0}, {1, 0, 0.5}}, type));
    const Scene s = scene(kWalking + "scale = 2\ncenter = [1, 2, 3]\nvelocity = [0, 0, 4]\n");
    const Collider& collider = s.colliders.at(0);
    const auto at_start = std::get<MeshBody>(collider.shape),
               later = std::get<MeshBody>(shape_at(collider, 0.25)),
               at_end = std::get<MeshBody>(shape_at(collider, 9));
    EXPECT_EQ(at_start.mesh->vertices()[1], Vec3(2, 0, 0));
    EXPECT_EQ(later.mesh->vertices()[1], Vec3(3, 0, 0));
    EXPECT_EQ(later.center, Vec3(1, 2, 4));
    EXPECT_EQ(at_end.mesh->vertices()[3], Vec3(2, 0, 3));
  }
}

TEST_F(BodyFiles, FramesArePartOfTheContent) {
  write("b.obj", kTetrahedron);
  write("w.npy", npy({{0, 0, 0}, {1, 0, 0}}));
  const std::string rigid = content(scene("file = \"b.obj\"\n")), moves = content(scene(kWalking));
  EXPECT_NE(moves, rigid);
  EXPECT_NE(content(scene(kWalking + "center = [1, 0, 0]\n")), moves);
  EXPECT_NE(content(scene("file = \"b.obj\"\nframes = \"w.npy\"\nfps = 3\n")), moves);
  write("w.npy", npy({{0, 0, 0}, {1, 0, 0}}, "<f4"));  // the same numbers
  EXPECT_EQ(content(scene(kWalking)), moves);
  write("w.npy", npy({{0, 0, 0}, {1, 0, 1e-6}}));
  EXPECT_NE(content(scene(kWalking)), moves);
}

TEST_F(BodyFiles, WhatIsWrongWithFramesIsNamed) {
  write("b.obj", kTetrahedron);
  const auto says = [&](const std::string& file) {
    write("w.npy", file);
    return errors(kWalking);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(says(npy({{0, 0, 0}, {1, 0, 0}})), "");
  EXPECT_SAYS(errors("file = \"b.obj\"\nframes = \"none.npy\"\nfps = 2\n"),
              "x.toml:8:10: 'frames'");
  EXPECT_SAYS(errors("file = \"b.obj\"\nframes = \"b.obj\"\nfps = 2\n"), "ends in .npy");
  EXPECT_SAYS(says("something else"), "begins with");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {1, 0, 0}}, "<i8")), "positions are float32 or float64");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {1, 0, 0}}, "<f8", "(2, 12)")), "[frames, vertices, 3]");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {1, 0, 0}}, "<f8", "(2, 4, 3)", "True")), "Fortran");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {1, 0, 0}}, "<f8", "(3, 4, 3)")), "after 2 whole frames");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, "<f8", "(4, 3, 3)")),
              "w.npy: has 3 vertices in a frame, and 'file' has 4");
  EXPECT_SAYS(says(npy({{0, 0, 0}})), "w.npy: has one frame");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {0, nan, 0}})), "w.npy: frame 1: vertex 0 is not finite");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {2e6, 0, 0}})), "reaches farther");
  EXPECT_SAYS(says(npy({{0, 0, 0}, {200, 0, 0}})),
              "x.toml:8:10: 'frames' in [[collider]]: the body jumps: from frame 0 to frame 1 "
              "vertex 0 makes 6.25 m");
  std::string flat = npy({{0, 0, 0}, {0, 0, 0}});
  flat.replace(flat.size() - 8, 8, 8, '\0');  // the last z
  EXPECT_SAYS(says(flat), "frame 1: the triangle of vertices 0, 1 and 3 has no area");
  std::string inside_out = npy({{0, 0, 0}, {0, 0, 0}});
  inside_out.back() = static_cast<char>(0xbf);  // -1
  EXPECT_SAYS(says(inside_out), "frame 1: it encloses no volume, or is turned inside out");
}

TEST_F(BodyFiles, FramesNeedARateAndARateFrames) {
  write("b.obj", kTetrahedron);
  write("w.npy", npy({{0, 0, 0}, {1, 0, 0}}));
  const std::string frames = "file = \"b.obj\"\nframes = \"w.npy\"\n";
  EXPECT_SAYS(errors(frames), "'fps'");
  EXPECT_SAYS(errors("file = \"b.obj\"\nfps = 2\n"), "x.toml:8:7: 'fps'");
  for (const char* fps : {"0", "-1", "nan", "\"x\""})
    EXPECT_SAYS(errors(frames + "fps = " + fps + "\n"), "x.toml:9:7: 'fps'");
  const std::string all = errors("file = \"none.obj\"\nframes = \"none.npy\"\nfps = 0\n");
  for (const char* part : {"none.obj", "none.npy", "'fps'"}) EXPECT_SAYS(all, part);
}

}  // namespace
}  // namespace taut::body_io_test
