"use client";
import { useEffect } from "react";
import { markAndFind } from "../../mark-and-find.js";

export default function Page() {
  useEffect(() => void markAndFind().then((result) => (document.title = result)), []);
  return null;
}
