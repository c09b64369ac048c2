// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The camera's images, each decoded when it is first shown.
import { BadPayload, isObject } from "../payload.ts";

export interface CameraImage {
  stamp_s: number;
  type: "image/jpeg" | "image/png";
  data: string;
}

const MOST_KEPT = 48;
const BASE64 = /^[A-Za-z0-9+/]*={0,2}$/;

/** Reads them if they are there. */
export function readImages(value: unknown): CameraImage[] {
  if (value === undefined || value === null) return [];
  const isImage = (one: unknown) =>
    isObject(one) && typeof one["stamp_s"] === "number" && (one["type"] === "image/jpeg" || one["type"] === "image/png") &&
    typeof one["data"] === "string" && BASE64.test(one["data"]);
  if (!Array.isArray(value) || !value.every(isImage)) throw new BadPayload('"images" must be a list of JPEG or PNG images in base64, with stamps.');
  return value as unknown as CameraImage[];
}

/** The number of the image nearest to a stamp, -1 without images; stamps ascend. */
export function nearestImage(images: readonly { stamp_s: number }[], stamp: number): number {
  let low = 0;
  let high = images.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (images[middle].stamp_s < stamp) low = middle + 1;
    else high = middle;
  }
  return low > 0 && stamp - images[low - 1].stamp_s <= images[low].stamp_s - stamp ? low - 1 : images.length === 0 ? -1 : low;
}

export class CameraImages {
  private readonly kept = new Map<number, HTMLImageElement>();

  /** @param loaded called when an image that was asked for has been decoded */
  constructor(private readonly images: readonly CameraImage[], private readonly loaded: () => void) {}

  get any(): boolean {
    return this.images.length > 0;
  }

  nearest(stamp: number): number {
    return nearestImage(this.images, stamp);
  }

  /** How long after a stamp an image was taken [s]. */
  offset(index: number, stamp: number): number {
    return this.images[index].stamp_s - stamp;
  }

  /** The image, once it is decoded. */
  get(index: number): HTMLImageElement | undefined {
    let image = this.kept.get(index);
    if (!image) {
      const { type, data } = this.images[index];
      image = new Image();
      image.addEventListener("load", () => this.loaded());
      image.src = `data:${type};base64,${data}`;
      this.kept.set(index, image);
      if (this.kept.size > MOST_KEPT) this.kept.delete(this.kept.keys().next().value!);
    }
    return image.complete && image.naturalWidth > 0 ? image : undefined;
  }
}
