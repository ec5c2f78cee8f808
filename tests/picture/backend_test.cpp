#include "softpoint/picture/backend.h"

#include <cstdlib>
#include <optional>

#include "gl/api.h"
#include "gl/context.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

std::unique_ptr<GlContext> make_real() { return make_gl_context(built_backends().front()); }
std::unique_ptr<GlContext> make_nothing() { throw Error("out of paint"); }
std::unique_ptr<GlContext> make_little() {
  class Little final : public GlContext {
   public:
    void make_current() override {}
    void release() override {}
    Function function(const char*) const override { return nullptr; }
    Backend backend() const override { return Backend::kEgl; }
  };
  return std::make_unique<Little>();
}

// An environment variable for as long as this object lives.
class Environment {
 public:
  explicit Environment(const char* value) {
    if (const char* before = std::getenv(kName)) before_ = before;
    value ? setenv(kName, value, 1) : unsetenv(kName);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { before_ ? setenv(kName, before_->c_str(), 1) : unsetenv(kName); }

 private:
  static constexpr const char* kName = "SOFTPOINT_PICTURE_BACKEND";
  std::optional<std::string> before_;
};

RenderSettings settings_for(Backend backend) {
  RenderSettings settings = plain_settings();
  settings.backend = backend;
  return settings;
}

TEST(Backend, EveryOneBuiltGivesARenderer) {
  ASSERT_FALSE(built_backends().empty());
  for (const Backend backend : built_backends()) {
    const Renderer renderer(settings_for(backend));
    EXPECT_EQ(renderer.backend(), backend);
    EXPECT_NE(renderer.driver(), "");
  }
}

TEST(Backend, OneNotBuiltIsRefusedWithThoseThatAre) {
  for (const Backend backend : {Backend::kOsmesa, Backend::kEgl, static_cast<Backend>(7)}) {
    const std::vector<Backend> built = built_backends();
    if (std::find(built.begin(), built.end(), backend) != built.end()) continue;
    const std::string message = refusal([&] { Renderer renderer(settings_for(backend)); });
    EXPECT_TRUE(mentions(message, "backend = \"" + std::string(backend_name(backend)) + "\"")) << message;
    EXPECT_TRUE(mentions(message, "permitted in this build is auto, ")) << message;
    EXPECT_TRUE(mentions(message, std::string(backend_name(built.front())))) << message;
  }
}

TEST(Backend, AutoTakesTheFirstBuilt) {
  const Environment none(nullptr);
  EXPECT_EQ(Renderer(settings_for(Backend::kAuto)).backend(), built_backends().front());
  const Environment empty("");
  EXPECT_EQ(Renderer(settings_for(Backend::kAuto)).backend(), built_backends().front());
  const Environment said("auto");
  EXPECT_EQ(Renderer(settings_for(Backend::kAuto)).backend(), built_backends().front());
}

TEST(Backend, TheEnvironmentDecidesForAutoAlone) {
  for (const Backend named : built_backends()) {
    const Environment environment(std::string(backend_name(named)).c_str());
    EXPECT_EQ(Renderer(settings_for(Backend::kAuto)).backend(), named);
    for (const Backend backend : built_backends()) {
      EXPECT_EQ(Renderer(settings_for(backend)).backend(), backend);
    }
  }
}

TEST(Backend, AWrongEnvironmentIsRefusedByName) {
  const Environment environment("vulkan");
  const std::string message = refusal([] { Renderer renderer(settings_for(Backend::kAuto)); });
  EXPECT_TRUE(mentions(message, "SOFTPOINT_PICTURE_BACKEND = \"vulkan\": permitted in this build is auto"))
      << message;
}

TEST(Backend, AutoFallsBackToTheNextThatWorks) {
  const BackendEntry built[] = {{Backend::kEgl, &make_nothing}, {Backend::kOsmesa, &make_real}};
  EXPECT_EQ(choose_gl_context(built, Backend::kAuto, nullptr)->backend(), built_backends().front());
  const BackendEntry incomplete[] = {{Backend::kEgl, &make_little}, {Backend::kOsmesa, &make_real}};
  EXPECT_EQ(choose_gl_context(incomplete, Backend::kAuto, nullptr)->backend(), built_backends().front());
}

TEST(Backend, WhenNoneWorksTheErrorNamesEachWithItsReason) {
  const BackendEntry built[] = {{Backend::kOsmesa, &make_nothing}, {Backend::kEgl, &make_little}};
  EXPECT_EQ(refusal([&] { choose_gl_context(built, Backend::kAuto, nullptr); }),
            "backend = \"auto\": no OpenGL 3.3 here; tried osmesa: out of paint; egl: the driver has no "
            "glActiveTexture");
}

TEST(Backend, OneAskedForIsTheOnlyOneTried) {
  const BackendEntry built[] = {{Backend::kOsmesa, &make_nothing}, {Backend::kEgl, &make_real}};
  EXPECT_EQ(refusal([&] { choose_gl_context(built, Backend::kOsmesa, nullptr); }),
            "backend = \"osmesa\": no OpenGL 3.3 here; tried osmesa: out of paint");
  EXPECT_EQ(refusal([&] { choose_gl_context(built, Backend::kAuto, "osmesa"); }),
            "SOFTPOINT_PICTURE_BACKEND = \"osmesa\": no OpenGL 3.3 here; tried osmesa: out of paint");
  const BackendEntry lone[] = {{Backend::kOsmesa, &make_real}};
  EXPECT_EQ(refusal([&] { choose_gl_context(lone, Backend::kAuto, "egl"); }),
            "SOFTPOINT_PICTURE_BACKEND = \"egl\": permitted in this build is auto, osmesa");
}

// Mesa keeps one current context per thread for all backends, and each backend its own idea of it.
TEST(Backend, MakingCurrentHoldsAgainstAnotherBackend) {
  for (const Backend first : built_backends()) {
    for (const Backend second : built_backends()) {
      const auto a = make_gl_context(first), b = make_gl_context(second);
      const GlApi gl_a(*a), gl_b(*b);
      // A binding is state of the context in which it was made.
      const auto bound = [](const GlApi& gl) {
        GLint name = 0;
        gl.GetIntegerv(GL_ARRAY_BUFFER_BINDING, &name);
        return name;
      };
      a->make_current();
      GLuint buffers[3] = {};
      gl_a.GenBuffers(3, buffers);
      gl_a.BindBuffer(GL_ARRAY_BUFFER, buffers[2]);
      for (int i = 0; i < 2; ++i) {
        b->make_current();
        EXPECT_EQ(bound(gl_b), 0) << backend_name(first) << ", then " << backend_name(second);
        a->make_current();
        EXPECT_EQ(bound(gl_a), static_cast<GLint>(buffers[2]))
            << backend_name(second) << ", then " << backend_name(first);
      }
      a->release();
    }
  }
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
