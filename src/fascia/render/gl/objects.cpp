#include <fascia/render/gl/objects.h>

#include <array>
#include <string_view>

#include <fascia/base/error.h>

namespace fascia::gl {
namespace {

std::string logOf(GLuint id, bool program) {
  std::array<char, 2048> text{};
  const auto capacity = static_cast<GLsizei>(text.size());
  if (program)
    glGetProgramInfoLog(id, capacity, nullptr, text.data());
  else
    glGetShaderInfoLog(id, capacity, nullptr, text.data());
  return text.data();
}

void attachShader(GLuint program, GLenum type, const std::string& defines,
                  const std::string& source) {
  const std::string_view header = "#version 330 core\n";
  const std::array<const char*, 3> parts{header.data(), defines.c_str(), source.c_str()};
  const GLuint shader = glCreateShader(type);
  glShaderSource(shader, static_cast<GLsizei>(parts.size()), parts.data(), nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (!ok) {
    const std::string log = logOf(shader, false);
    glDeleteShader(shader);
    glDeleteProgram(program);
    throw Error("the OpenGL driver refused a shader: " + log);
  }
  glAttachShader(program, shader);
  glDeleteShader(shader);
}

template <void (*&generate)(GLsizei, GLuint*)>
GLuint generateOne() {
  GLuint id = 0;
  generate(1, &id);
  return id;
}

}  // namespace

GLuint TextureKind::create() {
  return generateOne<epoxy_glGenTextures>();
}
void TextureKind::destroy(GLuint id) {
  glDeleteTextures(1, &id);
}
GLuint BufferKind::create() {
  return generateOne<epoxy_glGenBuffers>();
}
void BufferKind::destroy(GLuint id) {
  glDeleteBuffers(1, &id);
}
GLuint VertexArrayKind::create() {
  return generateOne<epoxy_glGenVertexArrays>();
}
void VertexArrayKind::destroy(GLuint id) {
  glDeleteVertexArrays(1, &id);
}
GLuint FramebufferKind::create() {
  return generateOne<epoxy_glGenFramebuffers>();
}
void FramebufferKind::destroy(GLuint id) {
  glDeleteFramebuffers(1, &id);
}
GLuint RenderbufferKind::create() {
  return generateOne<epoxy_glGenRenderbuffers>();
}
void RenderbufferKind::destroy(GLuint id) {
  glDeleteRenderbuffers(1, &id);
}
GLuint SamplerKind::create() {
  return generateOne<epoxy_glGenSamplers>();
}
void SamplerKind::destroy(GLuint id) {
  glDeleteSamplers(1, &id);
}

Program::Program(const std::string& vertexSource, const std::string& fragmentSource,
                 const std::string& defines)
    : id_(glCreateProgram()) {
  attachShader(id_, GL_VERTEX_SHADER, defines, vertexSource);
  attachShader(id_, GL_FRAGMENT_SHADER, defines, fragmentSource);
  glLinkProgram(id_);
  GLint ok = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &ok);
  if (!ok) {
    const std::string log = logOf(id_, true);
    glDeleteProgram(id_);
    throw Error("the OpenGL driver refused a program: " + log);
  }
}

Program::~Program() {
  glDeleteProgram(id_);
}

void Program::use() const {
  glUseProgram(id_);
}

GLint Program::location(const char* name) {
  const auto [it, isNew] = locations_.try_emplace(name, -1);
  if (isNew) it->second = glGetUniformLocation(id_, name);
  return it->second;
}

void Program::set(const char* name, int value) {
  glUniform1i(location(name), value);
}
void Program::set(const char* name, float value) {
  glUniform1f(location(name), value);
}
void Program::set(const char* name, const Eigen::Vector2f& value) {
  glUniform2fv(location(name), 1, value.data());
}
void Program::set(const char* name, const Eigen::Vector3f& value) {
  glUniform3fv(location(name), 1, value.data());
}
void Program::set(const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, value.data());
}

void bindTexture(int unit, GLuint texture, GLuint sampler) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture);
  glBindSampler(static_cast<GLuint>(unit), sampler);
}

void uploadLevel(const Texture& texture, int level, int width, int height,
                 const TextureFormat& format, const void* data) {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, level, static_cast<GLint>(format.internal), width, height, 0,
               format.external, format.type, data);
}

void allocateTexture(const Texture& texture, int width, int height, const TextureFormat& format,
                     GLenum filter, const void* data) {
  uploadLevel(texture, 0, width, height, format, data);
  for (GLenum which : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, which, static_cast<GLint>(filter));
  for (GLenum which : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, which, GL_CLAMP_TO_EDGE);
}

void attachTexture(const Framebuffer& framebuffer, GLenum attachment, const Texture& texture) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture.id(), 0);
}

void requireComplete(const char* what) {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(std::string("the OpenGL driver cannot draw into ") + what);
}

}  // namespace fascia::gl
