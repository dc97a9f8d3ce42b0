!> Rest and lift-off in the steps of the fast spectra; the rules are those of `rwmf_rest`.
module rwmf_fast_rest
   use rwmf_fast_grid, only: fast_grid_t, ground_at, ground_end
   use rwmf_fast_law, only: fast_law_t
   use rwmf_fast_series, only: find_root, newton_to_powers
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: find_wake, comes_to_rest

   real(wp), parameter :: beyond = 1 + 4*epsilon(1.0_wp)
   !! the drive exceeds the threshold by more than round-off

contains

   !> Where a wall that rests at the position x of a step lifts off.
   pure subroutine find_wake(law, grid, loud, number, x, side)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      !! from `loud_steps`
      integer, intent(inout) :: number
      !! of the step; beyond the last one: never
      real(wp), intent(inout) :: x
      !! [-]
      integer, intent(out) :: side
      !! to which it lifts off, +1 or -1
      real(wp) :: begin
      real(wp) :: limit
      real(wp) :: f
      real(wp) :: p(0:3)

      limit = law%threshold*beyond
      side = 1
      do
         if (number > size(grid%step)) return
         f = ground_at(grid%step(number), x)
         if (abs(f) > limit) exit
         f = ground_end(grid%step(number))
         if (abs(f) > limit) then
            p = newton_to_powers(grid%step(number)%f)*sign(1.0_wp, f)
            p(0) = p(0) - law%threshold
            begin = x
            call find_root(p, begin, 1.0_wp, x)
            exit
         end if
         number = loud(number + 1)
         x = 0
      end do
      side = merge(-1, 1, f > 0)
   end subroutine find_wake

   !> May the wall be put to rest after an impact? See `may_rest` of `rwmf_rest`.
   pure logical function comes_to_rest(law, grid, number, x, w, small_v, small_w) result(rests)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: number
      !! of the step
      real(wp), intent(in) :: x
      !! position in it [-]
      real(wp), intent(in) :: w
      !! rate of v after the impact [1/s]
      real(wp), intent(in) :: small_v
      !! negligible displacement over 2R [-]
      real(wp), intent(in) :: small_w
      !! negligible rate [1/s]
      real(wp) :: press
      !! deceleration of v [1/s2]
      real(wp) :: chatter
      !! [s]

      rests = .false.
      press = law%m2*(law%threshold - abs(ground_at(grid%step(number), x)))
      if (press <= 0) return
      rests = w <= max(small_w, press*64*spacing(grid%t(number)))
      if (rests .or. law%e >= 1 .or. w**2 > 2*press*small_v) return
      ! Twice the time that the present pressure allows leaves room for a smaller one meanwhile.
      chatter = 4*w/(press*(1 - law%e))
      press = least_pressure(law, grid, number, x, chatter)
      rests = press > 0 .and. 2*w <= press*(1 - law%e)*chatter
   end function comes_to_rest

   !> Smallest deceleration of v from a position on for a time; the acceleration of the ground is
   !> monotone within a step.
   pure real(wp) function least_pressure(law, grid, number, x, span) result(press)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: number
      real(wp), intent(in) :: x
      real(wp), intent(in) :: span
      !! [s]
      real(wp) :: largest
      real(wp) :: t_end
      integer :: i

      t_end = grid%t(number) + x*grid%step(number)%h + span
      largest = abs(ground_at(grid%step(number), x))
      do i = number, size(grid%step)
         associate (step => grid%step(i))
            if (i > number) largest = max(largest, abs(step%f(0)))
            largest = max(largest, abs(ground_at(step, min(1.0_wp, (t_end - grid%t(i))/step%h))))
            if (largest >= law%threshold .or. grid%t(i) + step%h >= t_end) exit
         end associate
      end do
      press = law%m2*(law%threshold - largest)
   end function least_pressure

end module rwmf_fast_rest
