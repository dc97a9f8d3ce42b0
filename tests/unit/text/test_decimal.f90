!> Shortest decimal text that reads back as the same number, for every kind of number.
program test_decimal
   use check, only: checks_t
   use rwmf_core_kinds, only: dp, i8, wp
   use rwmf_text_strings, only: real_to_text
   implicit none

   integer, parameter :: many = 20000
   type(checks_t) :: checks

   if (checks%wants('digits')) call check_digits()
   if (checks%wants('forms')) call check_forms()
   call checks%finish()

contains

   !> Digits of numbers of all sizes, near powers of two and halfway between decimals.
   subroutine check_digits()
      real(dp) :: u(3), x
      integer(i8) :: bits
      integer :: i, kind_number

      call random_init(repeatable=.true., image_distinct=.false.)
      do i = 1, many
         call random_number(u)
         kind_number = mod(i, 5)
         if (kind_number == 0) then
            bits = int(u(1)*2.0_dp**62, i8)
            x = abs(transfer(2*bits + mod(i, 2), x))
            if (.not. x <= huge(x)) cycle
         else if (kind_number == 1) then
            x = u(1)*10.0_dp**int(24*(u(2) - 0.5_dp))
         else if (kind_number == 2) then
            x = 2.0_dp**int(600*(u(1) - 0.5_dp))*(1 + (int(3*u(2)) - 1)*epsilon(x)/2)
         else if (kind_number == 3) then
            x = (int(1.0e9_dp*u(1), i8) + 0.5_dp)/2.0_dp**int(60*u(2))
         else
            x = int(1.0e15_dp*u(1), i8)*0.1_dp
         end if
         if (digits_of(real_to_text(real(x, wp))) == trial(x)) cycle
         call checks%that(.false., 'digits', real_to_text(real(x, wp)))
      end do
      call checks%that(.true., 'digits of many numbers')
   end subroutine check_digits

   !> Digits without zeros at both ends, point, sign and exponent.
   pure function digits_of(text) result(digits)
      character(*), intent(in) :: text
      character(25) :: digits
      integer :: i, n, last

      digits = ''
      n = 0
      last = scan(text//'e', 'eE') - 1
      do i = 1, last
         if (verify(text(i:i), '0123456789') > 0) cycle
         if (n == 0 .and. text(i:i) == '0') cycle
         n = n + 1
         digits(n:n) = text(i:i)
      end do
      n = verify(digits(:n), '0', back=.true.)
      digits(n + 1:) = ''
   end function digits_of

   !> Shortest digits by writing and reading with 15, 16 and 17 digits.
   function trial(x) result(digits)
      real(dp), intent(in) :: x
      character(25) :: digits
      character(40) :: buffer
      real(dp) :: again
      integer :: count, status
      character(3), parameter :: places(15:17) = ['14)', '15)', '16)']

      do count = 15, 17
         write (buffer, '(es40.'//places(count)(:2)//'e3)') x
         read (buffer, *, iostat=status) again
         if (status == 0 .and. abs(again - x) <= 0) exit
      end do
      digits = digits_of(adjustl(buffer))
   end function trial

   subroutine check_forms()
      real(wp), parameter :: numbers(12) = [0.0_wp, 1.0_wp, -0.5_wp, 1234.5_wp, 1.0e-4_wp, &
         -1.0e-5_wp, 9.0e14_wp, 1.0e15_wp, -2.5e-300_wp, 1.0e22_wp, 120.0_wp, 0.25_wp]
      character(12), parameter :: texts(12) = [character(12) :: '0.0', '1.0', '-0.5', '1234.5', &
         '0.0001', '-1.0e-5', '900000000000', '1.0e15', '-2.5e-300', '1.0e22', '120.0', '0.25']
      character(25) :: text
      integer :: i

      do i = 1, size(numbers)
         text = real_to_text(numbers(i))
         call checks%that(text(:12) == texts(i), 'form of '//texts(i), text)
      end do
   end subroutine check_forms

end program test_decimal
