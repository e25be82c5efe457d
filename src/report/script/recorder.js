// Recording the view as a film.

/** The kind of films that the browser records, or nothing where it records none. */
function filmType(canvas) {
  if (!canvas.captureStream || !window.MediaRecorder) return undefined;
  return ["video/webm;codecs=vp9", "video/webm"].find((type) => MediaRecorder.isTypeSupported(type));
}

/** What a second of the film takes [bits]. */
const FILM_RATE = 12_000_000;

class Recorder {
  constructor(canvas) {
    this.canvas = canvas;
    this.type = filmType(canvas);
  }

  get isRecording() {
    return this.recorder?.state === "recording";
  }

  /** Records from now on; the file is offered as `name` when that ends. */
  start(name) {
    const parts = [];
    this.recorder = new MediaRecorder(this.canvas.captureStream(), { mimeType: this.type, videoBitsPerSecond: FILM_RATE });
    this.recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
    this.recorder.addEventListener("stop", () => download(name, new Blob(parts), "video/webm"));
    this.recorder.start();
  }

  stop() {
    if (!this.isRecording) return;
    this.recorder.stop();
    this.recorder.stream.getTracks().forEach((track) => track.stop());
  }
}
