// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Many copies of one shape in one draw call, each with its own matrix, colour and opacity.
import {
  type BufferGeometry, Color, DoubleSide, DynamicDrawUsage, InstancedBufferAttribute, InstancedMesh, ShaderMaterial,
} from "three";
import { matrixOf, type Numbers } from "../math/rotation.ts";

const VERTEX = `
attribute vec4 tint;
#ifdef OWN_COLOURS
attribute vec3 axisColour;
#endif
varying vec4 vTint;
varying vec3 vNormal;
void main() {
  mat4 placed = modelViewMatrix * instanceMatrix;
  vec4 seen = placed * vec4(position, 1.0);
  vNormal = transpose(inverse(mat3(placed))) * normal;
  vTint = tint;
#ifdef OWN_COLOURS
  vTint.rgb = mix(axisColour, tint.rgb, ownShare);
#endif
  gl_Position = projectionMatrix * seen;
}`;

const FRAGMENT = `
varying vec4 vTint;
varying vec3 vNormal;
void main() {
  float facing = abs(normalize(vNormal).z);
#ifdef GLASS
  float alpha = vTint.a * (0.10 + 0.90 * pow(1.0 - facing, 2.0));
  gl_FragColor = vec4(vTint.rgb, alpha);
#else
  gl_FragColor = vec4(vTint.rgb * (0.65 + 0.35 * facing), vTint.a);
#endif
  #include <colorspace_fragment>
}`;

export interface BatchLook {
  /** Glassy look: the rim is more opaque than the middle. */
  glass?: boolean;
  /** Share of the instance's colour if the shape has its own colours, such as axes; 1: the instance's colour alone. */
  tintShare?: number;
  /** Whether it hides what is behind it. */
  solid?: boolean;
  /** Whether it is visible through what is in front of it. */
  onTop?: boolean;
  /** Only its nearest surface is drawn, so that a translucent mesh does not show its own far side. */
  shell?: boolean;
  /** What has a larger one is drawn later. */
  order?: number;
}

export class Batch {
  readonly mesh: InstancedMesh;
  private readonly matrices: Float32Array;
  private readonly tints: Float32Array;
  private readonly tintAttribute: InstancedBufferAttribute;
  private readonly rotation = new Float64Array(9);
  private readonly depth: InstancedMesh | undefined;
  private count = 0;

  constructor(shape: BufferGeometry, private readonly most: number, look: BatchLook = {}) {
    const own = shape.hasAttribute("axisColour");
    const material = new ShaderMaterial({
      vertexShader: own ? `const float ownShare = ${(look.tintShare ?? 0).toFixed(3)};\n${VERTEX}` : VERTEX,
      fragmentShader: FRAGMENT,
      defines: { ...(own ? { OWN_COLOURS: "" } : {}), ...(look.glass ? { GLASS: "" } : {}) },
      transparent: !look.solid,
      depthWrite: look.solid ?? false,
      depthTest: !look.onTop,
      side: DoubleSide,
    });
    const geometry = shape.clone();
    this.mesh = new InstancedMesh(geometry, material, Math.max(1, most));
    this.mesh.frustumCulled = false;
    this.mesh.count = 0;
    this.mesh.renderOrder = look.order ?? (look.onTop ? 5 : 0);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.matrices = this.mesh.instanceMatrix.array as Float32Array;
    this.tints = new Float32Array(4 * Math.max(1, most));
    this.tintAttribute = new InstancedBufferAttribute(this.tints, 4).setUsage(DynamicDrawUsage);
    geometry.setAttribute("tint", this.tintAttribute);
    if (look.shell) this.depth = this.nearest(geometry, material);
  }

  /** The same shape, of which the depth alone is drawn, right before. */
  private nearest(geometry: BufferGeometry, material: ShaderMaterial): InstancedMesh {
    const writing = material.clone();
    writing.colorWrite = false;
    writing.depthWrite = true;
    const depth = new InstancedMesh(geometry, writing, Math.max(1, this.most));
    depth.instanceMatrix = this.mesh.instanceMatrix;
    depth.frustumCulled = false;
    depth.renderOrder = this.mesh.renderOrder - 0.5;
    this.mesh.add(depth);
    return depth;
  }

  begin(): void {
    this.count = 0;
  }

  /** A copy rotated by q, with one size in all directions. */
  addPose(position: Numbers, q: Numbers, size: number, colour: Color, opacity: number): void {
    matrixOf(q, this.rotation);
    this.addLinear(position, this.rotation, size, colour, opacity);
  }

  /** A copy under the linear map `size * a`, a 3x3 matrix row by row. */
  addLinear(position: Numbers, a: Numbers, size: number, colour: Color, opacity: number): void {
    if (this.count === this.most) return;
    const m = this.matrices;
    const at = 16 * this.count;
    for (let column = 0; column < 3; ++column) {
      for (let row = 0; row < 3; ++row) m[at + 4 * column + row] = size * a[3 * row + column];
      m[at + 12 + column] = position[column];
    }
    m[at + 15] = 1;
    const tint = 4 * this.count++;
    this.tints[tint] = colour.r;
    this.tints[tint + 1] = colour.g;
    this.tints[tint + 2] = colour.b;
    this.tints[tint + 3] = opacity;
  }

  end(): void {
    this.mesh.count = this.count;
    if (this.depth) this.depth.count = this.count;
    this.mesh.visible = this.count > 0;
    this.mesh.instanceMatrix.needsUpdate = true;
    this.tintAttribute.needsUpdate = true;
  }
}
