"""What the scripts of MaterialX share: the driver that draws right, the generator, a renderer of one mesh, and images."""
import os

from common import CANNOT_RUN, stop

if not os.environ.get("DISPLAY"):
    stop("materialx", "its renderer needs an X11 display: install Xvfb", CANNOT_RUN)
# Mesa 22.3.6's llvmpipe draws light that is not there, at the left of a sphere and at its rim; its softpipe does not.
os.environ.setdefault("GALLIUM_DRIVER", "softpipe")
# The shader states GLSL 4.00 and needs no more than 3.30.
os.environ.setdefault("MESA_GL_VERSION_OVERRIDE", "4.0")
os.environ.setdefault("MESA_GLSL_VERSION_OVERRIDE", "400")
import MaterialX as mx
from MaterialX import PyMaterialXGenGlsl as gen_glsl, PyMaterialXGenShader as gen, PyMaterialXRender as render, PyMaterialXRenderGlsl as glsl

generator = gen_glsl.GlslShaderGenerator.create()
context = gen.GenContext(generator)
search = mx.getDefaultDataSearchPath()
context.registerSourceCodeSearchPath(search)
library = mx.createDocument()
mx.loadLibraries(mx.getDefaultDataLibraryFolders(), search, library)


def renderer_of(size, mesh):
    """A renderer of floats with the mesh of an OBJ file."""
    renderer = glsl.GlslRenderer.create(size, size, render.FLOAT)
    renderer.initialize()
    renderer.setImageHandler(glsl.GLTextureHandler.create(render.StbImageLoader.create()))
    renderer.getGeometryHandler().addLoader(render.TinyObjLoader.create())
    renderer.getGeometryHandler().loadGeometry(mx.FilePath(str(mesh)), False)
    return renderer


def image_of(texels):
    height, width, _ = texels.shape
    found = render.Image.create(width, height, 3, render.FLOAT)
    found.createResourceBuffer()
    for y in range(height):
        for x in range(width):
            found.setTexelColor(x, y, mx.Color4(*map(float, texels[y, x]), 1.0))
    return found
