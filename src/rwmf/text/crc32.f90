!> CRC-32 of a sequence of bytes: the short name by which an output file identifies its record.
module rwmf_text_crc32
   use, intrinsic :: iso_fortran_env, only: int32
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: crc32

   integer(int32), parameter :: polynomial = -306674912_int32
   !! IEEE 802.3 polynomial, bits reversed: hexadecimal EDB88320

contains

   !> CRC-32 with the IEEE polynomial, as zlib, gzip and PNG compute it.
   pure function crc32(bytes) result(digits)
      character(*), intent(in) :: bytes
      !! the sequence, a letter a byte
      character(8) :: digits
      !! hexadecimal, small letters
      integer(int32) :: crc
      integer(int32) :: low
      integer(int32) :: table(0:255)
      integer :: i

      table(:) = remainders()
      crc = not(0_int32)
      do i = 1, len(bytes)
         low = iand(ieor(crc, int(ichar(bytes(i:i)), int32)), 255_int32)
         crc = ieor(table(low), ishft(crc, -8))
      end do
      write (digits, '(z8.8)') not(crc)
      digits = to_lower(digits)
   end function crc32

   !> What each value of a byte contributes.
   pure function remainders() result(table)
      integer(int32) :: table(0:255)
      integer(int32) :: value
      integer :: bit
      integer :: byte

      do byte = 0, 255
         value = int(byte, int32)
         do bit = 1, 8
            value = ieor(ishft(value, -1), merge(polynomial, 0_int32, btest(value, 0)))
         end do
         table(byte) = value
      end do
   end function remainders

end module rwmf_text_crc32
