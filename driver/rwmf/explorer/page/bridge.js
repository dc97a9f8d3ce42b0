// Questions to the server. The token is in the fragment of the address, which browsers do not send;
// it goes back as a header, which pages of other origins may not set.

import { token } from "./address.js";

export class Refused extends Error {
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

async function send(path, body, signal) {
  const headers = { "X-Token": token() };
  const response = await fetch(path, { method: "POST", body, signal, headers }).catch((error) => {
    if (error.name === "AbortError") throw error;
    throw new Refused(0, "The server does not answer: it has ended. Start rwmf explore again.");
  });
  if (!response.ok) throw await failure(response);
  return response;
}

async function failure(response) {
  let message = `status ${response.status}`;
  try {
    message = (await response.json()).error;
  } catch { /* no message of the server */ }
  if (response.status === 403) message += ". Open the address that rwmf explore has printed.";
  return new Refused(response.status, message);
}

// Answer to a question.
export async function ask(path, question, signal) {
  const body = typeof question === "object" && !(question instanceof Blob)
    ? JSON.stringify(question) : question;
  return (await send(path, body, signal)).json();
}

// Answer that comes line by line: `report` gets all but the last.
export async function follow(path, question, signal, report) {
  const response = await send(path, JSON.stringify(question), signal);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) throw new Refused(0, "The answer broke off.");
    text += value;
    const lines = text.split("\n");
    text = lines.pop();
    for (const line of lines) {
      const item = JSON.parse(line);
      if (item.error) throw new Refused(422, item.error);
      if ("result" in item) return item.result;
      report(item);
    }
  }
}

// 32-bit floats of the server as an array; NaN becomes null, a gap in a line.
export function unpack(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  const values = new Float32Array(bytes.buffer);
  for (const value of values) {
    if (value !== value) return Array.from(values, (x) => (x === x ? x : null));
  }
  return values;
}
